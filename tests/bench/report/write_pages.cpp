// The report of a run; of two runs side by side; the figures of a run. For the tests in the browser.
// write_pages DIR | write_pages DIR OTHER OUT | write_pages DIR figures [CHART SOLVER|- FAMILY|- WIDTH]
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include <zwang/bench/report/report.h>

int main(int argc, char** argv) try {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 1)
    std::cout << zwang::report::write_report(words[0]).string() << "\n";
  else if (words.size() == 3)
    std::cout << zwang::report::write_comparison(words[0], words[1], words[2]).string() << "\n";
  else if (words.size() >= 2 && words[1] == "figures") {
    zwang::report::Figures figures{{"svg", "pdf"}};
    if (words.size() == 6)
      figures.charts = {words[2]}, figures.width = std::stod(words[5]);
    if (words.size() == 6 && words[3] != "-") figures.solvers = {words[3]};
    if (words.size() == 6 && words[4] != "-") figures.families = {words[4]};
    for (const auto& file : zwang::report::write_figures(words[0], figures)) std::cout << file.string() << "\n";
  } else {
    return 2;
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 2;
}
