#include <zwang/bench/campaign/merge.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include <zwang/bench/campaign/cell_list.h>
#include <zwang/bench/results/record_file.h>
#include <zwang/bench/suite/progress.h>

namespace zwang {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Where the line of a cell is.
struct Place {
  std::uint32_t part = 0, size = 0;  // size 0: nowhere
  std::uint64_t start = 0;
};

// Lines of results.jsonl by their places; the file read last stays open.
class Lines {
 public:
  explicit Lines(const std::vector<fs::path>& parts) : parts_(parts) {}
  const std::string& read(const Place& at) {
    if (open_ != &parts_[at.part]) {
      open_ = &parts_[at.part];
      in_ = std::ifstream(*open_ / "results.jsonl", std::ios::binary);
    }
    line_.resize(at.size);
    in_.seekg(static_cast<std::streamoff>(at.start));
    if (!in_.read(line_.data(), at.size)) throw BadFile((*open_ / "results.jsonl").string() + ": changed while read");
    return line_;
  }

 private:
  const std::vector<fs::path>& parts_;
  const fs::path* open_ = nullptr;
  std::ifstream in_;
  std::string line_;
};

// The column in which two lines of one run differ, clock aside.
std::string differing_column(const std::string& a, const std::string& b) {
  const Json one = Json::parse(a), other = Json::parse(b);
  if (one.value("claimed", "") != other.value("claimed", "")) return "claimed";
  const Json columns = Json::parse(without_clock(a));
  for (const auto& [name, value] : columns.items())
    if (other.value(name, Json()) != value) return name;
  return "its columns";
}

bool is_problem(const fs::path& file, const std::string& sha256) {
  try {
    const std::vector<Instance> read = read_problems(file);
    return read.size() == 1 && problem_sha256(read.front().problem) == sha256;
  } catch (const BadFile&) {
    return false;
  }
}

// One problem file from the first part that has an undamaged one.
bool copy_problem(const std::string& file, const std::string& sha256, const std::vector<fs::path>& parts,
                  const fs::path& out) {
  for (const fs::path& part : parts)
    if (fs::exists(part / file) && is_problem(part / file, sha256)) {
      fs::copy_file(part / file, out / file, fs::copy_options::overwrite_existing);
      return true;
    }
  return false;
}

// Everything but results: curves of all parts, as they are.
void append_traces(const std::vector<fs::path>& parts, const fs::path& out) {
  std::ofstream all;
  for (const fs::path& part : parts) {
    std::ifstream in(part / "traces.jsonl", std::ios::binary);
    for (std::string line; std::getline(in, line);) {
      if (!all.is_open()) all.open(out / "traces.jsonl", std::ios::binary);
      all << line << '\n';
    }
  }
}

// run.json of the whole: that of the first part, without its part.
void write_record(const std::vector<fs::path>& parts, const fs::path& out, const std::string& command,
                  const CellList& cells, const Merged& merged) {
  Json record;
  std::vector<std::string> notes;
  std::string started, finished;
  for (const fs::path& part : parts) {
    const Json one = Json::parse(load_record(part, "run"));
    if (record.is_null()) record = one;
    for (const std::string note : one.value("notes", Json::array()))
      if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
    const std::string begun = one.value("started", "");
    if (started.empty() || begun < started) started = begun;
    if (one.at("finished").is_string()) finished = std::max<std::string>(finished, one.at("finished"));
  }
  const auto common = std::ranges::max_element(merged.machines, {}, [](const auto& m) { return m.second; });
  if (common != merged.machines.end()) record["cpu"] = common->first;
  if (merged.machines.size() > 1) {
    std::string line = "Runs were made on " + std::to_string(merged.machines.size()) +
                       " kinds of machine, whose times do not compare:";
    for (const auto& [machine, runs] : merged.machines) line += " " + machine + " (" + grouped(runs) + ");";
    line.back() = '.';
    notes.push_back(line);
  }
  for (const std::string& line : merged.disagreeing) notes.push_back(line);
  record["command"] = command;
  record["started"] = started;
  record["finished"] = merged.present == merged.planned ? Json(finished) : Json();
  record["problems"] = cells.problems();
  record["runs"] = merged.planned;
  record["options"]["shard"] = "";
  record["machines"] = merged.machines;
  record["notes"] = notes;
  replace_record(out, record.dump(2));
}

}  // namespace

Merged merge(const std::vector<fs::path>& parts, const fs::path& out, const std::string& command) {
  const CellList cells(parts.front());
  for (const fs::path& part : parts)
    if (const std::string d = cells.difference(CellList(part)); !d.empty()) throw BadFile(d);
  if (holds_run(out)) throw std::invalid_argument(out.string() + " holds a run already: choose another --out");
  fs::create_directories(out / "problems");

  Merged merged{.planned = cells.size()};
  std::vector<Place> places(cells.size());
  Lines stored(parts);
  constexpr std::size_t most_reported = 100;
  for (std::size_t p = 0; p < parts.size(); ++p)
    merged.damaged += for_each_line(parts[p], cells, [&](const StoredLine& line) {
      Place& at = places[line.cell];
      if (at.size == 0) {
        at = {static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(line.text.size()), line.start};
        ++merged.present;
        ++merged.machines[line.machine];
        return;
      }
      const std::string& first = stored.read(at);
      const std::string second(line.text);
      if (without_clock(first) == without_clock(second))
        ++merged.twice;
      else if (merged.disagreeing.size() < most_reported)
        merged.disagreeing.push_back(cells.describe(line.cell) + ": " + parts[at.part].string() + " and " +
                                     parts[p].string() + " disagree in " + differing_column(first, second));
    });

  std::ofstream results(out / "results.jsonl", std::ios::binary);
  for (const Place& at : places)
    if (at.size > 0) results << stored.read(at) << '\n';
  results.close();
  if (!results) throw BadFile("cannot write " + (out / "results.jsonl").string());
  append_traces(parts, out);

  const std::size_t runs = cells.problems() > 0 ? cells.size() / cells.problems() : 0;
  for (std::size_t i = 0; i < cells.problems(); ++i) {
    const auto first = places.begin() + static_cast<std::ptrdiff_t>(i * runs);
    const bool run =
        std::any_of(first, first + static_cast<std::ptrdiff_t>(runs), [](auto& at) { return at.size > 0; });
    if (run && !copy_problem(problem_file(i), cells.problem_sha256(i), parts, out))
      merged.bad_problems.push_back(problem_file(i));
  }
  write_record(parts, out, command, cells, merged);
  return merged;
}

}  // namespace zwang
