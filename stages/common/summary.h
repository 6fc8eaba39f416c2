// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "geometry/base/types.h"
#include "pipeline/files/outputs.h"

namespace pneuma::stages::common {

using base::Vec3;

// summary.json: the result keys of the workflow contract, SI units. A key that was not computed is absent.
class Summary {
public:
  // `origin`: of the state's coordinates, in those of the user.
  explicit Summary(const Vec3& origin, const std::vector<std::string>& warnings = {});
  ~Summary();
  Summary(const Summary&) = delete;
  Summary& operator=(const Summary&) = delete;

  // `path` is dotted: "chambers.main.volume"; names may not hold dots. #N is a place in a list:
  // "patterns.upper.strips.#0.width".
  void set(const std::string& path, double value);
  void set(const std::string& path, int value);
  void set(const std::string& path, bool value);
  void set(const std::string& path, const std::string& value);
  void set(const std::string& path, const char* value) { set(path, std::string(value)); }
  void set(const std::string& path, const Vec3& value);
  void set_place(const std::string& path, const Vec3& local);     // told in the user's coordinates
  void append(const std::string& path, const std::string& value); // to a list of texts

  // Throws MachineError.
  void write(pipeline::files::Outputs& outputs) const;

private:
  struct Data;
  std::unique_ptr<Data> data_;
};

// history.csv: one row per accepted step, written at once. Columns are fixed by the first row.
class History {
public:
  explicit History(pipeline::files::Outputs& outputs);
  using Row = std::vector<std::pair<std::string, double>>; // column -> value, SI
  void add(const Row& row);

private:
  pipeline::files::Outputs& outputs_;
  std::unique_ptr<pipeline::files::GrowingFile> file_;
};

double peak_memory(); // bytes

// Seconds since it was made.
class Clock {
public:
  Clock();
  double seconds() const;

private:
  double start_;
};

} // namespace pneuma::stages::common
