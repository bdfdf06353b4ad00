// Reads problems and writes them again in zwang's own layout, for tests that look at files from outside:
// convert_problems IN OUT [LAW]. Prints each problem's name and SHA-256. Exit code 2 and one line on
// standard error for a bad file.
#include <cstdio>
#include <string>

#include <zwang/core/files/problem_file.h>

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: convert_problems IN OUT [LAW]\n");
    return 1;
  }
  try {
    const auto problems =
        argc > 3 ? zwang::read_problems(argv[1], zwang::parse_law(argv[3])) : zwang::read_problems(argv[1]);
    zwang::write_problems(argv[2], problems);
    for (const auto& in : problems)
      std::printf("%s %s\n", in.problem.name.c_str(), zwang::problem_sha256(in.problem).c_str());
  } catch (const zwang::BadFile& bad) {
    std::fprintf(stderr, "%s\n", bad.what());
    return 2;
  }
}
