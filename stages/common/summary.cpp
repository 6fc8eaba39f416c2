// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/common/summary.h"

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "geometry/base/errors.h"

namespace pneuma::stages::common {

using Json = nlohmann::ordered_json;

struct Summary::Data {
  Json json = Json::object();

  Json& at(const std::string& path) {
    Json* node = &json;
    std::size_t begin = 0;
    for (;;) {
      const std::size_t end = path.find('.', begin);
      const std::string key = path.substr(begin, end - begin);
      node = key.starts_with('#') ? &(*node)[std::stoul(key.substr(1))] : &(*node)[key];
      if (end == std::string::npos) return *node;
      begin = end + 1;
    }
  }
};

Summary::Summary() : data_(std::make_unique<Data>()) {}
Summary::~Summary() = default;

void Summary::set(const std::string& path, double value) {
  if (std::isfinite(value)) data_->at(path) = value; // JSON knows no NaN: the key stays absent
}
void Summary::set(const std::string& path, int value) {
  data_->at(path) = value;
}
void Summary::set(const std::string& path, bool value) {
  data_->at(path) = value;
}
void Summary::set(const std::string& path, const std::string& value) {
  data_->at(path) = value;
}
void Summary::set(const std::string& path, const Vec3& value) {
  data_->at(path) = {value.x(), value.y(), value.z()};
}
void Summary::append(const std::string& path, const std::string& value) {
  Json& list = data_->at(path);
  if (list.is_null()) list = Json::array();
  list.push_back(value);
}

namespace {

[[noreturn]] void cannot_write(const std::filesystem::path& file) {
  throw base::Error(base::ExitCode::bad_state, fmt::format("cannot write {}: {}", file.string(), std::strerror(errno)));
}

} // namespace

void Summary::write(const std::filesystem::path& file) const {
  std::filesystem::path temporary = file;
  temporary += ".tmp";
  {
    std::ofstream stream(temporary);
    stream << data_->json.dump(2) << '\n';
    stream.flush();
    if (!stream) cannot_write(file);
  }
  std::error_code error;
  std::filesystem::rename(temporary, file, error);
  if (error) cannot_write(file);
}

History::History(std::filesystem::path file) : file_(std::move(file)) {}

void History::add(const Row& row) {
  std::ofstream stream(file_, started_ ? std::ios::app : std::ios::trunc);
  if (!started_) {
    for (std::size_t i = 0; i < row.size(); ++i) stream << (i > 0 ? "," : "") << row[i].first;
    stream << '\n';
    started_ = true;
  }
  for (std::size_t i = 0; i < row.size(); ++i) stream << (i > 0 ? "," : "") << fmt::format("{}", row[i].second);
  stream << '\n';
  stream.flush();
  if (!stream) cannot_write(file_);
}

double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

Clock::Clock() : start_(now()) {}
double Clock::seconds() const {
  return now() - start_;
}

} // namespace pneuma::stages::common
