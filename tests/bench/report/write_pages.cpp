// The report of a run; of two runs side by side; the figures of a run. For the tests in the browser.
// write_pages DIR | write_pages DIR OTHER OUT | write_pages DIR figures
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
  else if (words.size() == 2 && words[1] == "figures")
    for (const auto& file : zwang::report::write_figures(words[0], {"svg", "pdf"})) std::cout << file.string() << "\n";
  else
    return 2;
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 2;
}
