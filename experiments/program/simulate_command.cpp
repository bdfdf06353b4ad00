#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/wording.h>
#include <zwang/bench/results/record_file.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/experiments/program/choices.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {
namespace {

namespace fs = std::filesystem;

// The options of the run in this folder; `--audit` alone may be asked for anew.
god::Record record_to_resume(const CLI::App& options, const std::string& resume, bool audit) {
  for (const CLI::Option* option : options.get_options())
    if (option->count() > 0 && option->get_name() != "--resume" && option->get_name() != "--audit")
      throw std::invalid_argument(
          "--resume " + resume + " goes on with the options of that run: " + option->get_name() + " has no part in it");
  god::require_same_program(resume);  // first: another program's record may lack what this one reads
  god::Record record = god::read_record(resume);
  record.asked.audit = record.asked.audit || audit;
  return record;
}

}  // namespace

int simulate_command(std::vector<std::string> words) {
  CLI::App options("Lets a tracked hand work among objects: the god hand follows it and stays out of them.");
  Choices choices;
  std::string out, resume;
  within(from(1), options.add_option("--frames", choices.asked.frames, "stop after so many"))->type_name("N");
  options.add_flag("--audit", choices.asked.audit, "FCL looks at every committed frame at the end");
  options.add_option("--out", out, "folder for the run; default: results/<date>-<time>")->type_name("DIR");
  options.add_option("--resume", resume, "go on with a run that was stopped, or write its page anew")->type_name("DIR");
  add_choices(options, "simulate",
              "  ./zwang simulate simple --motion grasp\n"
              "  ./zwang simulate engine --motion recording.json --solver nnls --rate 500 --audit\n"
              "  ./zwang simulate gear.stl@mm --motion press --seconds 2 --out gear\n"
              "  ./zwang simulate box --god fingers.json --motion grasp\n"
              "  ./zwang simulate box --motion slide --method paper --solver dual_active_set\n"
              "  ./zwang simulate --resume gear\n",
              choices);
  const std::string command = command_line("simulate", words);
  if (!read(options, std::move(words))) return done;

  const bool resumed = !resume.empty();
  god::Record record =
      resumed ? record_to_resume(options, resume, choices.asked.audit) : record_of(options, choices, command);
  const fs::path directory = resumed ? fs::path(resume) : new_directory(out, "./zwang simulate --resume");
  const god::Record stored = record;
  const god::Setup setup =
      resumed ? from_record(directory, [&record] { return god::set_up(record); }) : god::set_up(record);
  const char* changed = stored.motion != record.motion               ? "motion"
                        : stored.surroundings != record.surroundings ? "scene"
                        : stored.god != record.god                   ? "god object"
                                                                     : nullptr;
  if (resumed && changed)
    throw BadFile(directory.string() + " cannot go on: its " + changed + " is no longer what it was");
  std::printf("%s\n", head_line(record, setup).c_str());
  std::fflush(stdout);

  fs::create_directories(directory);
  const auto alone = only_writer(directory);
  god::write_record(directory, record);
  Progress bar;
  const double start = wall_seconds();
  const auto progress = [&](double fraction, const std::string& what) { bar.show(fraction, what); };
  const std::atomic<bool>& interrupted = stop_on_interrupt();
  long frames = record.asked.frames;
  if (record.finished.empty()) frames = god::simulate(directory, record, setup, resumed, progress, interrupted);
  const bool whole = frames == record.asked.frames;
  if (whole && record.finished.empty()) {
    record.finished = now_iso8601();
    god::write_record(directory, record);
  }
  if (!whole) record.asked.audit = false;
  const god::Finished finished = god::finish(directory, record, setup, progress);
  bar.clear();
  const std::string go_on = "./zwang simulate --resume " + report::shell_word(directory.string());
  for (const std::string& line : finished.summary.lines(record)) std::printf("%s\n", line.c_str());
  std::printf("Took %s: steps %s, the rest is the referee, the files and the page\n",
              duration(wall_seconds() - start).c_str(), duration(finished.summary.cost().seconds()).c_str());
  std::printf("Summary: %s\n", (directory / "summary.json").c_str());
  if (!finished.replay.empty()) std::printf("Replay: %s\n", finished.replay.c_str());
  if (!whole)
    std::printf("Stopped after %s of %s frames; nothing lost. Go on with: %s\n", grouped(frames).c_str(),
                grouped(record.asked.frames).c_str(), go_on.c_str());
  return whole ? done : stopped;
}

}  // namespace zwang
