#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/scenes/hand.h>
#include <zwang/core/files/stored_file.h>
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

struct Look {
  const char* name;
  const char* color;
};

Look look(const std::string& type) {
  if (type == "universal_joint") return {"universal joints", "#8a6fd1"};
  if (type == "revolute_joint") return {"revolute joints", "#3d83d0"};
  if (type == "joint_limit") return {"limits", "#c79a1e"};
  return {"contacts", "#2aa08f"};
}

std::string attributes(const char* form, double a, double b, double c, double d) {
  char text[160];
  std::snprintf(text, sizeof text, form, a, b, c, d);
  return text;
}

// A cell for every stored entry of J; bodies along the columns, constraint types along the rows. Opaque background: it
// reads on a dark page too.
std::string matrix_svg(const Instance& instance) {
  constexpr double cell = 6, left = 150, top = 96, right = 24, bottom = 30;
  const Problem& p = instance.problem;
  const double width = left + cell * static_cast<double>(p.size()) + right,
               height = top + cell * static_cast<double>(p.rows()) + bottom;
  std::string svg =
      attributes("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %g %g\" width=\"%g\" height=\"%g\"", width,
                 height, width, height) +
      " font-family=\"Arial, 'Liberation Sans', sans-serif\" font-size=\"11\" fill=\"#1b1f24\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  const auto rect = [&svg](double x, double y, double w, double h, const std::string& fill) {
    svg += attributes("<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\"", x, y, w, h) + " fill=\"" + fill + "\"/>\n";
  };
  const auto text = [&svg](double x, double y, const std::string& more, const std::string& words) {
    svg += attributes("<text x=\"%g\" y=\"%g\"", x, y, 0, 0) + " " + more + ">" + words + "</text>\n";
  };
  const double matrix_height = cell * static_cast<double>(p.rows());
  for (int body = 0; body < hand::bodies; ++body) {
    const double x = left + 6 * cell * body;
    rect(x, top, 6 * cell, matrix_height, body % 2 == 0 ? "#f3f5f8" : "#e9edf2");
    text(x + 3.6 * cell, top - 6, attributes("transform=\"rotate(-52 %g %g)\"", x + 3.6 * cell, top - 6, 0, 0),
         hand::body_name(body));
  }
  for (const Section& s : sections(instance)) {
    const double y = top + cell * static_cast<double>(s.first), tall = cell * static_cast<double>(s.rows);
    if (s.first > 0) rect(left - 12, y - 0.5, width - left - right + 12, 1, "#9aa4b1");
    rect(left - 12, y + 2, 4, tall - 4, look(s.type).color);
    text(left - 20, y + tall / 2 - 1, "text-anchor=\"end\" font-weight=\"600\"", look(s.type).name);
    text(left - 20, y + tall / 2 + 12, "text-anchor=\"end\" fill=\"#57606a\"", std::to_string(s.rows) + " rows");
    for (Index i = s.first; i < s.first + s.rows; ++i)
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator at(p.J, i); at; ++at)
        if (at.value() != 0)
          rect(left + cell * static_cast<double>(at.col()) + 0.5, top + cell * static_cast<double>(i) + 0.5, cell - 1,
               cell - 1, look(s.type).color);
  }
  text(left, height - 10, "fill=\"#57606a\"",
       "J of " + p.name + ": " + std::to_string(p.rows()) + " x " + std::to_string(p.size()) +
           ", six columns a body [linear; angular]");
  return svg + "</svg>\n";
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
      const std::string label = i == s.first ? std::string(look(s.type).name) + " " + std::to_string(s.rows) : "";
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
            "  ./zwang hand --matrix --contacts 40 --out matrix.svg");
  bool matrix = false;
  int contacts = 24, limits = 6;
  std::string out;
  options.add_flag("--matrix", matrix, "draw the sparsity of J, (70 + limits + contacts) x 96");
  options.add_option("--contacts", contacts, "contact rows; default: 24")->check(from_to(0, 60));
  options.add_option("--limits", limits, "violated limits; default: 6")->check(from_to(0, 20));
  options.add_option("--out", out, "as a figure, too")->type_name("FILE.svg");
  if (!read(options, std::move(words))) return done;
  if (!matrix) throw std::invalid_argument("what of the hand? --matrix draws its sparsity (./zwang hand --help)");

  const Instance hand =
      make_scenes("hand(contacts=" + std::to_string(contacts) + ",limits=" + std::to_string(limits) + ")")[0];
  print_matrix(hand);
  const Problem& p = hand.problem;
  std::printf("J is %ld x %ld with %ld entries that are not zero: %.1f %%\n", static_cast<long>(p.rows()),
              static_cast<long>(p.size()), static_cast<long>(p.J.nonZeros()),
              100.0 * static_cast<double>(p.J.nonZeros()) / static_cast<double>(p.rows() * p.size()));
  if (out.empty()) return done;
  replace_file(out, matrix_svg(hand));
  std::printf("Figure: %s\n", out.c_str());
  return done;
}

}  // namespace zwang
