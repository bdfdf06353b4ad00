// The program `zwang`: the comparison alone.
#include <zwang/bench/program/program.h>

int main(int count, char** arguments) { return zwang::program(count, arguments); }
