// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/common/summary.h"

#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

namespace pneuma::stages::common {

using Json = nlohmann::ordered_json;

struct Summary::Data {
  Vec3 origin;
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

Summary::Summary(const Vec3& origin, const std::vector<std::string>& warnings) : data_(std::make_unique<Data>()) {
  data_->origin = origin;
  for (const std::string& warning : warnings) append("warnings", warning);
}
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
void Summary::set_place(const std::string& path, const Vec3& local) {
  set(path, Vec3(data_->origin + local));
}
void Summary::append(const std::string& path, const std::string& value) {
  Json& list = data_->at(path);
  if (list.is_null()) list = Json::array();
  list.push_back(value);
}

void Summary::write(pipeline::files::Outputs& outputs) const {
  pipeline::files::write_file(outputs.file("summary.json"), data_->json.dump(2) + "\n");
}

History::History(pipeline::files::Outputs& outputs) : outputs_(outputs) {}

void History::add(const Row& row) {
  std::string text;
  if (!file_) {
    file_ = std::make_unique<pipeline::files::GrowingFile>(outputs_.file("history.csv"));
    for (std::size_t i = 0; i < row.size(); ++i) text += (i > 0 ? "," : "") + row[i].first;
    text += '\n';
  }
  for (std::size_t i = 0; i < row.size(); ++i) text += fmt::format("{}{}", i > 0 ? "," : "", row[i].second);
  file_->add(text + "\n");
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
