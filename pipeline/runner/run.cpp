// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/runner/run.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "geometry/base/errors.h"
#include "geometry/base/log.h"
#include "pipeline/digest/digest.h"
#include "pipeline/files/file.h"
#include "pipeline/runner/freshness.h"
#include "pipeline/runner/process.h"
#include "pipeline/schema/spelling.h"

namespace pneuma::pipeline::runner {

using base::ExitCode;
using workflow::StageSettings;
using workflow::Workflow;

namespace fs = std::filesystem;

fs::path output_folder(const Workflow& workflow, const fs::path& out) {
  if (!out.empty()) return out;
  // W.yml must not share the folder of W.yaml
  const bool is_usual = workflow.file.extension() == ".yaml";
  return workflow.file.parent_path() / "out" / (is_usual ? workflow.file.stem() : workflow.file.filename());
}

namespace {

using Clock = std::chrono::steady_clock;

enum class Progress : std::uint8_t { waiting, running, done, failed, left_out };

struct Job {
  Job(const StageSettings& settings, const fs::path& out)
      : stage(&settings), files(out / settings.id), from(settings.from) {}

  const StageSettings* stage;
  StageFiles files;
  std::string from; // empty: starts from nothing
  bool selected = true;
  bool anew = false;
  Progress progress = Progress::waiting;
  int exit_code = 0;
  std::string state; // sha256 of its result once done
  Provenance made_from;
  Child child;
  std::string note; // about its input, which it warns of
  std::string unfinished_line;
  std::unique_ptr<files::GrowingFile> log; // none: not running, or it cannot be written
  Clock::time_point start;
};

fs::path program_of(const StageSettings& stage) {
  return program_folder() / ("pneuma-" + stage.run);
}

bool is_interruption(int code) { // 128 + SIGINT is also what a stage that was interrupted ends with
  return code == 128 + SIGINT || code == 128 + SIGTERM || code == 128 + SIGHUP || code == 128 + SIGKILL;
}

class Runner {
public:
  Runner(const Workflow& workflow, const RunOptions& options) : workflow_(workflow), options_(options) {
    const fs::path out = output_folder(workflow, options.out);
    for (const StageSettings& stage : workflow.stages) {
      jobs_.emplace_back(stage, out);
    }
    select();
  }

  int run() {
    const fs::path out = output_folder(workflow_, options_.out);
    files::make_folder(out, files::Links::followed);
    const FolderLock lock(out);
    const Interrupts interrupts;
    if (isatty(STDOUT_FILENO) == 1) base::Progress::expect_in_pipes();
    if (!options_.only.empty()) check_input_of(job(options_.only));
    set_threads();
    while (true) {
      if (interrupted_ == 0) start_ready();
      if (running() == 0) break;
      listen(interrupts);
    }
    return conclude();
  }

private:
  Job& job(const std::string& id) {
    const auto found = std::find_if(jobs_.begin(), jobs_.end(), [&](const Job& j) { return j.stage->id == id; });
    if (found != jobs_.end()) return *found;
    std::vector<std::string> ids;
    for (const Job& known : jobs_) ids.push_back(known.stage->id);
    throw base::InputError(
        fmt::format("there is no stage `{}`{}; stages: {}", id, schema::suggestion(id, ids), schema::joined(ids)));
  }

  bool depends_on(const Job& later, const std::string& id) {
    for (std::string at = later.stage->id; !at.empty(); at = job(at).from) {
      if (at == id) return true;
    }
    return false;
  }

  void select() {
    if (!options_.from.empty()) {
      const Job& first = job(options_.from);
      for (Job& other : jobs_) {
        other.anew = depends_on(other, options_.from);
        other.selected = other.anew || depends_on(first, other.stage->id);
      }
    }
    if (!options_.only.empty()) {
      const Job& one = job(options_.only);
      for (Job& other : jobs_) other.selected = &other == &one;
    }
    for (const std::string& id : options_.force) force(job(id));
  }

  void force(Job& one) {
    one.anew = true;
    if (one.selected) return;
    const std::string& id = one.stage->id;
    throw base::InputError(
        options_.only.empty()
            ? fmt::format("--force {0}: --from {1} runs what `{1}` needs, it and what depends on it, and `{0}` is none "
                          "of them; leave one of the two away",
                          id, options_.from)
            : fmt::format("--force {0}: --only {1} runs `{1}` alone, `{0}` would not run; leave one of the two away",
                          id, options_.only));
  }

  // A stage alone takes its input as it is, if it is a finished one.
  void check_input_of(Job& one) {
    if (one.from.empty()) return;
    Job& input = job(one.from);
    input.state = good_state(input.files);
    const std::optional<Provenance> made = read_provenance(input.files.provenance);
    if (input.state.empty() || !made || made->state() != input.state) {
      throw base::StateError(fmt::format(
          "{}: the state it starts from, `{}`, is missing, damaged or unfinished; run `{}` first, or leave --only away",
          one.stage->id, input.files.state.string(), one.from));
    }
    input.progress = Progress::done;
    const Verdict verdict =
        examine(input.files, wanted(input, made->input), workflow::stage_yaml(workflow_, *input.stage));
    if (verdict.fresh) return;
    one.note = fmt::format("`{}` is used as it is, although {}", input.stage->id, verdict.reason);
    say(fmt::format("{}: {}", one.stage->id, one.note));
  }

  // A chain of stages never runs side by side: then each gets all cores.
  void set_threads() {
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const auto is_last = [&](const Job& one) {
      return one.selected && std::none_of(jobs_.begin(), jobs_.end(), [&](const Job& other) {
               return other.selected && other.from == one.stage->id;
             });
    };
    const int branches = static_cast<int>(std::count_if(jobs_.begin(), jobs_.end(), is_last));
    side_by_side_ = std::clamp(options_.jobs > 0 ? options_.jobs : cores, 1, std::max(1, branches));
    threads_ = std::max(1, cores / side_by_side_);
  }

  Provenance wanted(const Job& one, const std::string& input) const {
    Provenance provenance;
    provenance.settings = digest::sha256_of_text(workflow::effective_settings(workflow_, *one.stage));
    provenance.input = input;
    provenance.executable = digest::sha256_of_file(program_of(*one.stage));
    return provenance;
  }

  int running() const {
    return static_cast<int>(
        std::count_if(jobs_.begin(), jobs_.end(), [](const Job& one) { return one.progress == Progress::running; }));
  }

  void start_ready() {
    // a stage that is up to date may make others ready
    for (bool changed = true; changed;) {
      changed = false;
      for (Job& one : jobs_) {
        if (!one.selected || one.progress != Progress::waiting) continue;
        const Progress before = one.from.empty() ? Progress::done : job(one.from).progress;
        if (before == Progress::failed || before == Progress::left_out) {
          say(fmt::format("{}: not run: `{}` has no result", one.stage->id, one.from));
          one.progress = Progress::left_out;
          changed = true;
        } else if (before == Progress::done && running() < side_by_side_) {
          unless_refused(one, [&] { begin(one); });
          changed = true;
        }
      }
    }
  }

  // What the machine refuses to one stage stops neither its siblings nor the runner.
  template <class Work>
  void unless_refused(Job& one, const Work& work) {
    try {
      work();
    } catch (const base::Error& error) {
      fail(one, static_cast<int>(error.code()), error.what());
    }
  }

  void begin(Job& one) {
    const fs::path program = program_of(*one.stage);
    check_program(program);
    one.made_from = wanted(one, one.from.empty() ? "" : job(one.from).state);
    const std::string config = workflow::stage_yaml(workflow_, *one.stage);
    const Verdict verdict = examine(one.files, one.made_from, config);
    if (verdict.fresh && !one.anew) {
      one.state = read_provenance(one.files.provenance)->state();
      one.progress = Progress::done;
      // lines of the user's file may have moved
      std::vector<yaml::Problem> ignored;
      if (yaml::read_text(one.files.config, {}, ignored) != config) files::write_file(one.files.config, config);
      return say(fmt::format("{}: up to date", one.stage->id));
    }
    say(fmt::format("{}: runs: {}", one.stage->id, verdict.fresh ? "asked for" : verdict.reason));
    files::make_folder(one.files.folder);
    remove_results(one.files);
    files::write_file(one.files.config, config);
    one.log = std::make_unique<files::GrowingFile>(one.files.log);
    std::vector<std::string> arguments = {"--config", one.files.config.string()};
    if (!one.from.empty()) arguments.insert(arguments.end(), {"--in", job(one.from).files.state.string()});
    arguments.insert(arguments.end(), {"--out", one.files.state.string(), "--threads", std::to_string(threads_)});
    if (!one.note.empty()) arguments.insert(arguments.end(), {"--note", one.note});
    one.start = Clock::now();
    one.child = start(program, arguments);
    one.progress = Progress::running;
  }

  void fail(Job& one, int code, const std::string& why) {
    one.progress = Progress::failed;
    one.exit_code = code;
    say(fmt::format("{}: failed: {}", one.stage->id, why));
  }

  // Waits for something to happen: a line of a stage, its end, Ctrl-C.
  void listen(const Interrupts& interrupts) {
    std::vector<pollfd> watched = {{interrupts.descriptor(), POLLIN, 0}};
    std::vector<Job*> owners = {nullptr};
    for (Job& one : jobs_) {
      if (one.progress != Progress::running) continue;
      watched.push_back({one.child.output, POLLIN, 0});
      owners.push_back(&one);
    }
    if (poll(watched.data(), watched.size(), -1) < 0) return;
    if (watched[0].revents != 0) interrupt(interrupts.take());
    for (std::size_t i = 1; i < watched.size(); ++i) {
      if (watched[i].revents != 0) hear(*owners[i]);
    }
  }

  void interrupt(int number) {
    if (number == 0) return;
    const bool again = interrupted_ != 0;
    interrupted_ = number;
    say(again ? "interrupted again: the running stages are killed"
              : "interrupted: the running stages end; what is done is kept (once more: kill them)");
    for (const Job& one : jobs_) {
      if (one.progress == Progress::running) send_signal(one.child, again ? SIGKILL : number);
    }
  }

  void hear(Job& one) {
    char buffer[1 << 14];
    const ssize_t count = read(one.child.output, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) return;
    if (count <= 0) return end(one);
    one.unfinished_line.append(buffer, static_cast<std::size_t>(count));
    for (auto end_of_line = one.unfinished_line.find('\n'); end_of_line != std::string::npos;
         end_of_line = one.unfinished_line.find('\n')) {
      tell(one, one.unfinished_line.substr(0, end_of_line));
      one.unfinished_line.erase(0, end_of_line + 1);
    }
  }

  // Progress is shown in place and leaves no trace; other lines stay, here and in the log.
  void tell(Job& one, const std::string& line) {
    if (line.rfind(base::Progress::mark, 0) == 0) {
      progress_line_.show(fmt::format("{}: {}", one.stage->id, line.substr(1)));
      return;
    }
    log(one, line);
    say(fmt::format("{}: {}", one.stage->id, line));
  }

  void log(Job& one, const std::string& line) {
    if (one.log == nullptr) return;
    try {
      one.log->add(line + "\n");
    } catch (const base::MachineError& error) {
      one.log.reset();
      say(fmt::format("{}: its log ends here: {}", one.stage->id, error.what()));
    }
  }

  // One line of the runner, below what it has said so far.
  void say(const std::string& line) {
    progress_line_.done();
    base::say(line);
  }

  void end(Job& one) {
    close(one.child.output);
    if (!one.unfinished_line.empty()) tell(one, one.unfinished_line);
    one.unfinished_line.clear();
    const int code = wait_for(one.child);
    one.log.reset();
    if (interrupted_ != 0 && is_interruption(code)) {
      one.progress = Progress::failed;
      return say(fmt::format("{}: interrupted", one.stage->id));
    }
    if (code > 128) return fail(one, static_cast<int>(ExitCode::bug), fmt::format("ended by signal {}", code - 128));
    if (code == 127) return fail(one, static_cast<int>(ExitCode::machine_refuses), "its program could not be started");
    unless_refused(one, [&] { record(one, code); });
  }

  // Notes what a stage that ended by itself was made from and what it left.
  void record(Job& one, int code) {
    one.made_from.outputs = digests_of_outputs(one.files);
    one.made_from.exit_code = code;
    one.made_from.verdict = verdict_in(one.files.summary);
    if (code == 0 && good_state(one.files).empty()) {
      return fail(one, static_cast<int>(ExitCode::bug), "it ended well but left no state that matches its digest");
    }
    write_provenance(one.files.provenance, one.made_from);
    if (code != 0) {
      return fail(one, code, fmt::format("exit code {}; its output is in {}", code, one.files.log.string()));
    }
    one.state = one.made_from.state();
    one.progress = Progress::done;
    const double seconds = std::chrono::duration<double>(Clock::now() - one.start).count();
    say(fmt::format("{}: done in {:.1f} s", one.stage->id, seconds));
  }

  int conclude() const {
    if (interrupted_ != 0) return static_cast<int>(ExitCode::interrupted);
    const auto failed =
        std::find_if(jobs_.begin(), jobs_.end(), [](const Job& one) { return one.progress == Progress::failed; });
    return failed != jobs_.end() ? failed->exit_code : static_cast<int>(ExitCode::done);
  }

  const Workflow& workflow_;
  const RunOptions& options_;
  std::vector<Job> jobs_; // in the order of the file
  int side_by_side_ = 1;
  int threads_ = 1;
  int interrupted_ = 0;
  base::Progress progress_line_;
};

} // namespace

int run(const Workflow& workflow, const RunOptions& options) {
  return Runner(workflow, options).run();
}

} // namespace pneuma::pipeline::runner
