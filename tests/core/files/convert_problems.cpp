// Reads problems and writes them again in zwang's own layout, for tests that look at files from outside:
// convert_problems IN OUT [none | pyramid]. Prints each problem's name and SHA-256. Exit code 2 and one line on
// standard error for a bad file.
#include <cstdio>
#include <string>

#include <zwang/core/files/problem_file.h>

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: convert_problems IN OUT [none | pyramid]\n");
    return 1;
  }
  try {
    const bool pyramid = argc > 3 && std::string(argv[3]) == "pyramid";
    const auto problems = zwang::read_problems(argv[1], pyramid ? zwang::Friction::pyramid : zwang::Friction::none);
    zwang::write_problems(argv[2], problems);
    for (const auto& in : problems)
      std::printf("%s %s\n", in.problem.name.c_str(), zwang::problem_sha256(in.problem).c_str());
  } catch (const zwang::BadFile& bad) {
    std::fprintf(stderr, "%s\n", bad.what());
    return 2;
  }
}
