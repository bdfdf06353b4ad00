#include <zwang/core/files/problem_file.h>

#include <unistd.h>

#include <cstdlib>
#include <new>

#include <zwang/core/files/layouts.h>

namespace zwang {
namespace {

constexpr const char* own = "zwang";

bool holds_problem(const hdf5::Group& group) {
  return group.has_group(own) || group.has_group("fclib_global") || group.has_group("fclib_global_rolling") ||
         group.has_group("fclib_local");
}

// A problem's group may carry what is known about it beside the FCLIB group: truth/status (0 solved, 1 infeasible) and
// truth/z, of the problem without friction.
void read_truth(const hdf5::Group& group, Instance& instance) {
  if (!group.has_group("truth")) return;
  const hdf5::Group truth = group.group("truth");
  const auto status = truth.read_one<std::int64_t>("status");
  if (status != 0 && status != 1)
    truth.fail("status", "is " + std::to_string(status) + "; expected 0 (solved) or 1 (infeasible)");
  Reference reference{.hearsay = true};
  reference.feasible = status == 0;
  reference.method = "file";
  if (reference.feasible) reference.z = read_vector(truth, "z", at(instance.problem.size()));
  instance.reference = std::move(reference);
}

// "GAP_-0x1p-3" -> family GAP, knob -0.125: collections name swept problems so.
void read_knob(const std::string& name, Instance& instance) {
  const auto underscore = name.find('_');
  if (underscore == std::string::npos || name.find("0x", underscore) == std::string::npos) return;
  char* end = nullptr;
  const double value = std::strtod(name.c_str() + underscore + 1, &end);
  if (*end != '\0') return;
  instance.family = name.substr(0, underscore);
  instance.knob = "knob";
  instance.knob_value = value;
}

// What every layout shares: the problem must be one that a solver may see.
void require_good(const Fail& fail, const Instance& instance) {
  if (const std::string reason = bad_input(instance.problem); reason.ends_with("finite number"))
    fail("", reason + "; expected finite numbers (c = -Inf on an inequality row is allowed)");
  else if (!reason.empty())
    fail("", reason);
  if (!is_positive_definite(instance.problem.M)) fail("M", "not positive definite; expected a mass matrix");
}

Instance read_problem(const hdf5::Group& group, const std::string& name, std::optional<Law> law) {
  Instance instance;
  std::string layout = own;
  if (group.has_group(own)) {
    instance = read_own(group.group(own));
  } else if (group.has_group("fclib_local")) {
    instance = read_fclib_local(group.group(layout = "fclib_local"), law);
  } else {
    const bool rolling = !group.has_group("fclib_global");
    layout = rolling ? "fclib_global_rolling" : "fclib_global";
    instance = read_fclib_global(group.group(layout), law, rolling);
  }
  require_good(failing(group.group(layout)), instance);
  if (law) instance = under(*law, std::move(instance));
  if (instance.problem.name.empty()) instance.problem.name = name;
  if (!instance.reference && !instance.problem.has_tangents()) read_truth(group, instance);
  return instance;
}

Instance read_text(const std::filesystem::path& file, std::optional<Law> law) {
  Instance instance = read_siconos(file, law);
  require_good([&](const std::string&, const std::string& what) { throw BadFile(file.string() + ": " + what); },
               instance);
  if (law) instance = under(*law, std::move(instance));
  instance.problem.name = file.stem().string();
  instance.family = "siconos";
  return instance;
}

std::vector<Instance> read_all(const std::filesystem::path& file, std::optional<Law> law) {
  if (file.extension() == ".dat") return {read_text(file, law)};
  const hdf5::Group root = hdf5::Group::open(file);
  const std::string stem = file.stem().string();
  std::vector<Instance> all;
  if (holds_problem(root)) {
    all.push_back(read_problem(root, stem, law));
    if (all.back().family.empty()) all.back().family = root.has_group(own) ? stem : "fclib";
    return all;
  }
  for (const std::string& name : root.groups()) {
    const hdf5::Group group = root.group(name);
    if (!holds_problem(group)) continue;
    all.push_back(read_problem(group, name, law));
    if (all.back().family.empty()) read_knob(name, all.back());
    if (all.back().family.empty()) all.back().family = stem;
  }
  if (all.empty()) root.fail("", "no problem found; expected a group 'zwang', 'fclib_global' or 'fclib_local'");
  return all;
}

}  // namespace

std::vector<Instance> read_problems(const std::filesystem::path& file, std::optional<Law> law) {
  try {
    return read_all(file, law);
  } catch (const std::bad_alloc&) {
    throw BadFile(file.string() + ": too large for the memory; expected a problem that fits");
  }
}

// One problem is the file; several are one group each, numbered in their order. The file appears under its name only
// when it is complete.
void write_problems(const std::filesystem::path& file, std::span<const Instance> instances) {
  const std::filesystem::path unfinished = file.string() + ".unfinished-" + std::to_string(getpid());
  try {
    hdf5::Group root = hdf5::Group::create(unfinished, false, file.string());
    const std::size_t digits = std::to_string(instances.size()).size();
    for (std::size_t k = 0; k < instances.size(); ++k) {
      require_matching_sizes(instances[k].problem);
      std::string number = std::to_string(k);
      number.insert(0, digits - number.size(), '0');
      hdf5::Group parent = instances.size() == 1 ? root : root.add_group(number);
      hdf5::Group group = parent.add_group(own);
      write_own(group, instances[k]);
    }
    root.flush();
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    throw;
  }
  std::error_code error;
  std::filesystem::rename(unfinished, file, error);
  if (error) throw BadFile(file.string() + ": cannot be written (" + error.message() + "); expected a writable place");
}

void write_problem(const std::filesystem::path& file, const Instance& instance) {
  write_problems(file, {&instance, 1});
}

}  // namespace zwang
