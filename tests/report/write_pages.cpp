// write_pages DIR [OTHER OUT]: the report of a run, or of two runs side by side, for the tests in the browser.
#include <exception>
#include <iostream>

#include "experiments/report/report.h"

int main(int argc, char** argv) try {
  if (argc == 2)
    std::cout << zwang::report::write_report(argv[1]).string() << "\n";
  else if (argc == 4)
    std::cout << zwang::report::write_comparison(argv[1], argv[2], argv[3]).string() << "\n";
  else
    return 2;
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 2;
}
