#include "bench/suite/measured_files.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "core/problem_file.h"

namespace zwang {
namespace {

std::filesystem::path data_file(const std::string& stem) {
  const char* elsewhere = std::getenv("ZWANG_DATA");
  const std::filesystem::path data = elsewhere ? elsewhere : ZWANG_SOURCE_DIR "/../shared/data";
  return data / "problems" / (stem + ".h5");
}

// Collections name their problems by number, and HDF5 lists names in the order of letters.
long number_of(const Instance& instance) {
  const std::string& name = instance.problem.name;
  const auto digits = name.find_last_not_of("0123456789") + 1;
  return std::strtol(name.c_str() + std::min(digits, name.size()), nullptr, 10);
}

std::vector<Instance> read_in_order(const std::string& stem) {
  const std::filesystem::path file = data_file(stem);
  if (!std::filesystem::exists(file)) return {};
  std::vector<Instance> all = read_problems(file, Friction::none);
  std::sort(all.begin(), all.end(), [](const Instance& a, const Instance& b) { return number_of(a) < number_of(b); });
  return all;
}

struct File {
  std::string family, knob;
  int value;
  std::size_t every = 1;
};

}  // namespace

std::vector<Instance> measured_problems() {
  std::vector<File> files;
  for (const int contacts : {0, 4, 16, 64, 200}) files.push_back({"H", "contacts", contacts});
  for (const int hands : {1, 2, 4, 8, 64}) files.push_back({"K", "hands", hands});
  for (const int boxes : {10, 100}) files.push_back({"tower", "boxes", boxes});
  for (const int boxes : {100, 1000}) files.push_back({"wall", "boxes", boxes});
  files.push_back({"stress", "", 0, 10});

  std::vector<Instance> chosen;
  for (const auto& [family, knob, value, every] : files) {
    const std::vector<Instance> all = read_in_order(family + (knob.empty() ? "" : std::to_string(value)));
    for (std::size_t i = 0; i < all.size(); i += every) {
      chosen.push_back(all[i]);
      Instance& instance = chosen.back();
      const bool box = family == "tower" || family == "wall";
      instance.family = box ? family + " file" : family;
      instance.knob = knob;
      instance.knob_value = value;
    }
  }
  return chosen;
}

std::vector<Instance> measured_sequence(int contacts) { return read_in_order("seq" + std::to_string(contacts)); }

}  // namespace zwang
