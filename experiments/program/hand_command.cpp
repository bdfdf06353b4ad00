#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {
namespace {

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
  // Rows of one constraint type lie together.
  for (Index first = 0, end = 0; first < p.rows(); first = end) {
    const std::string& type = instance.origin[static_cast<std::size_t>(first)].type;
    while (end < p.rows() && instance.origin[static_cast<std::size_t>(end)].type == type) ++end;
    std::string label = std::string(plural(type)) + " " + std::to_string(end - first);
    for (Index i = first; i < end; i += 2, label.clear()) {
      std::printf("%-20s", label.c_str());
      for (Index j = 0; j < p.size(); j += 2) {
        if (j > 0 && j % 18 == 6) std::printf(" ");
        std::printf(
            "%s",
            blocks[set(i, j, end) + 2 * set(i, j + 1, end) + 4 * set(i + 1, j, end) + 8 * set(i + 1, j + 1, end)]);
      }
      std::puts("");
    }
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
  within(from_to(0, 60), options.add_option("--contacts", contacts, "contact rows; default: 24"));
  within(from_to(0, 20), options.add_option("--limits", limits, "violated limits; default: 6"));
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
