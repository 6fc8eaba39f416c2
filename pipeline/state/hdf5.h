// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

// What a state needs of HDF5: files in memory, with groups of plain arrays and texts. The only door to libhdf5.
namespace pneuma::pipeline::state::hdf5 {

// A file is not what the caller expects: where in the file, and what is wrong there.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Owns an identifier of libhdf5.
class Handle {
public:
  using Close = int (*)(std::int64_t);
  Handle(std::int64_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Handle& operator=(Handle&&) = delete;
  ~Handle();
  std::int64_t id() const { return id_; }

private:
  std::int64_t id_;
  Close close_;
};

using Shape = std::vector<std::uint64_t>;
inline constexpr std::uint64_t any = std::numeric_limits<std::uint64_t>::max(); // in an expected shape

// An open group. Every dataset is contiguous, of fixed-size elements, and has a unit; T is double, int32, int64 or
// uint8. Links that lead out of the file, filters and converted types are refused when read.
class Group {
public:
  Group create(const std::string& name) const;
  Group open(const std::string& name) const;

  template <class T>
  void write(const std::string& name, std::span<const T> values, const Shape& shape, const std::string& unit) const;
  void write(const std::string& name, const std::vector<std::string>& texts) const; // without NUL
  void set_attribute(const std::string& name, const std::string& text) const;
  void set_attribute(const std::string& name, const std::vector<std::int64_t>& numbers) const;

  // Reads a dataset whose shape must be `expected`, entry by entry (`any` matches all).
  template <class T>
  std::vector<T> read(const std::string& name, const Shape& expected) const;
  std::vector<std::string> read_texts(const std::string& name, std::uint64_t expected = any) const;
  std::string unit(const std::string& dataset) const;
  std::string text_attribute(const std::string& name) const;
  std::vector<std::int64_t> number_attribute(const std::string& name) const;

private:
  friend class File;
  friend std::string new_file(const std::function<void(const Group&)>&);
  Group(Handle handle, std::string path, std::uint64_t limit)
      : handle_(std::move(handle)), path_(std::move(path)), limit_(limit) {}
  std::string where(const std::string& name) const { return path_ + name; }
  Handle open_dataset(const std::string& name) const;
  Shape shape(const Handle& dataset, const std::string& name, std::uint64_t size, const Shape& expected) const;

  Handle handle_;
  std::string path_;    // within the file, ends in a slash
  std::uint64_t limit_; // bytes of the file: no dataset is larger
};

// A file opened from its bytes: nothing of it is on disk, so that the bytes can be judged before they are parsed.
class File {
public:
  explicit File(const std::string& bytes); // must stay as long as the file
  Group root() const;

private:
  Handle handle_;
  std::uint64_t limit_;
};

// The bytes of a new file that `fill` fills, beginning at its root. The same content filled in the same order gives the
// same bytes.
std::string new_file(const std::function<void(const Group& root)>& fill);

} // namespace pneuma::pipeline::state::hdf5
