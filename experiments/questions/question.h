#pragma once

#include <atomic>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace zwang::questions {

// One value of a chart. Series are told apart by colour, in the order they first occur.
struct Point {
  std::string series;
  double x, y;
};

// A level that the paper names, drawn across the chart.
struct Level {
  double y;
  std::string text;
};

struct Chart {
  enum class Kind { lines, points, shares };  // shares: stacked to 100 %
  std::string name, title;                    // file name without ending; what one sees
  std::string x, y;                           // axis titles, with units
  Kind kind = Kind::lines;
  bool log_x = false, log_y = false;
  std::vector<Point> points = {};
  std::vector<Level> levels = {};
  std::string figure = {};  // charts of one figure are drawn into one file of that name, two in a row
};

// What was found: a table (first column: what; the paper's own figures stand in a column of theirs), charts, and what
// the table does not say.
struct Findings {
  std::vector<std::string> columns = {};
  std::vector<std::vector<std::string>> rows = {};
  std::vector<Chart> charts = {};
  std::vector<std::string> remarks = {};
};

// How a question is asked.
struct Asking {
  std::filesystem::path data = {};         // folder of recordings and real parts; may be absent
  std::filesystem::path parts = {};        // real parts in place of procedural ones; empty: procedural
  std::string solver = "dual_active_set";  // of the questions that do not compare solvers
  std::string motion = {};                 // a recording, in place of the question's own
  double seconds = 0;                      // of motion; 0: all of it
  const std::atomic<bool>* interrupted = nullptr;
  bool terminal = false;  // show a progress bar
};

// A question that the paper answers in words or in a figure, and that a run here answers in numbers.
struct Question {
  std::string name;
  std::string line;   // the question
  std::string paper;  // where the paper answers it, and how
  Findings (*ask)(const Asking& asking);
};

// In the order of the paper.
std::span<const Question> questions();

}  // namespace zwang::questions
