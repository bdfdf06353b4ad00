#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {
namespace {

// Rows of one constraint type, which lie together.
struct Section {
  std::string type;
  Index first, rows;
};

std::vector<Section> sections(const Instance& instance) {
  std::vector<Section> all;
  for (Index i = 0; i < instance.problem.rows(); ++i) {
    const std::string& type = instance.origin[static_cast<std::size_t>(i)].type;
    if (all.empty() || all.back().type != type) all.push_back({type, i, 0});
    ++all.back().rows;
  }
  return all;
}

const char* plural(const std::string& type) {
  if (type == "universal_joint") return "universal joints";
  if (type == "revolute_joint") return "revolute joints";
  return type == "joint_limit" ? "limits" : "contacts";
}

// Two rows and two columns a character.
void print_matrix(const Instance& instance) {
  static const char* const blocks[] = {" ", "▘", "▝", "▀", "▖", "▌", "▞", "▛", "▗", "▚", "▐", "▜", "▄", "▙", "▟", "█"};
  const Problem& p = instance.problem;
  const auto set = [&p](Index i, Index j, Index end) { return i < end && p.J.coeff(i, j) != 0 ? 1 : 0; };
  std::printf("%-20s", "");
  for (const char* name : {"palm", "thumb", "index", "middle", "ring", "little"})
    std::printf("%-*s", std::string(name) == "palm" ? 4 : 10, std::string(name) == "palm" ? "p" : name);
  std::puts("");
  for (const Section& s : sections(instance))
    for (Index i = s.first; i < s.first + s.rows; i += 2) {
      const std::string label = i == s.first ? std::string(plural(s.type)) + " " + std::to_string(s.rows) : "";
      std::printf("%-20s", label.c_str());
      for (Index j = 0; j < p.size(); j += 2) {
        if (j > 0 && j % 18 == 6) std::printf(" ");
        const Index end = s.first + s.rows;
        std::printf(
            "%s",
            blocks[set(i, j, end) + 2 * set(i, j + 1, end) + 4 * set(i + 1, j, end) + 8 * set(i + 1, j + 1, end)]);
      }
      std::puts("");
    }
}

}  // namespace

int hand_command(std::vector<std::string> words) {
  CLI::App options("The problem of one pressed hand: 16 bodies, 70 joint rows, violated limits, contacts.");
  introduce(options, "hand",
            "  ./zwang hand --matrix\n"
            "  ./zwang hand --matrix --contacts 40");
  bool matrix = false;
  int contacts = 24, limits = 6;
  options.add_flag("--matrix", matrix, "draw the sparsity of J, (70 + limits + contacts) x 96");
  options.add_option("--contacts", contacts, "contact rows; default: 24")->check(from_to(0, 60));
  options.add_option("--limits", limits, "violated limits; default: 6")->check(from_to(0, 20));
  if (!read(options, std::move(words))) return done;
  if (!matrix) throw std::invalid_argument("what of the hand? --matrix draws its sparsity (./zwang hand --help)");

  const Instance hand =
      make_scenes("hand(contacts=" + std::to_string(contacts) + ",limits=" + std::to_string(limits) + ")")[0];
  print_matrix(hand);
  const Problem& p = hand.problem;
  std::printf("J is %ld x %ld with %ld entries that are not zero: %.1f %%\n", static_cast<long>(p.rows()),
              static_cast<long>(p.size()), static_cast<long>(p.J.nonZeros()),
              100.0 * static_cast<double>(p.J.nonZeros()) / static_cast<double>(p.rows() * p.size()));
  return done;
}

}  // namespace zwang
