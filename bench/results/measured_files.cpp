#include <zwang/bench/results/measured_files.h>

#include <filesystem>

#include <zwang/bench/scenes/recorded_data.h>
#include <zwang/core/files/problem_file.h>

namespace zwang {
namespace {

std::vector<Instance> read_file(const std::string& stem) {
  const std::filesystem::path file = recorded_data() / "problems" / (stem + ".h5");
  return std::filesystem::exists(file) ? read_problems(file, no_friction) : std::vector<Instance>();
}

// The files name their rows by number, and a limit that appears renumbers all contacts behind it: a warm start then
// begins with the wrong rows. Here an inequality row has the key of the row of the frame before whose
// coefficients are nearest, where they are near (frames differ by 6e-4, neighbouring contacts by 1e-1), or a new one.
void follow_rows(std::vector<Instance>& frames) {
  constexpr double near = 0.05;
  std::uint64_t next = std::uint64_t{1} << 32;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    Problem& p = frames[f].problem;
    const Problem* before = f > 0 ? &frames[f - 1].problem : nullptr;
    std::vector<char> taken(before ? before->kind.size() : 0, 0);
    for (Index i = 0; i < p.rows(); ++i) {
      if (p.is_equality(i)) continue;
      const Vector row = p.J.row(i).transpose();
      Index nearest = -1;
      double least = near * row.norm();
      for (Index j = 0; before && j < before->rows(); ++j) {
        if (before->is_equality(j) || taken[at(j)]) continue;
        const double distance = (before->J.row(j).transpose() - row).norm();
        if (distance < least) least = distance, nearest = j;
      }
      RowKey& key = p.key[at(i)];
      if (nearest < 0) {
        key = {next++, 0};
        continue;
      }
      key = before->key[at(nearest)];
      taken[at(nearest)] = 1;
    }
  }
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
    const std::vector<Instance> all = read_file(family + (knob.empty() ? "" : std::to_string(value)));
    for (std::size_t i = 0; i < all.size(); i += every) {
      Instance& instance = chosen.emplace_back(all[i]);
      const bool box = family == "tower" || family == "wall";
      instance.family = box ? family + " file" : family;
      instance.knob = knob;
      instance.knob_value = value;
    }
  }
  return chosen;
}

std::vector<Instance> measured_sequence(int contacts) {
  std::vector<Instance> frames = read_file("seq" + std::to_string(contacts));
  follow_rows(frames);
  return frames;
}

}  // namespace zwang
