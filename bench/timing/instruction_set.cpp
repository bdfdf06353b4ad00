#include <zwang/bench/timing/instruction_set.h>

#include <unistd.h>
#include <utility>

// Compiled for the first x86-64 (CMakeLists.txt): this must run everywhere.

namespace zwang {
namespace {

unsigned of_this_cpu() {
  unsigned there = 0;
#if defined(__x86_64__)
  __builtin_cpu_init();
#define INSTRUCTION_SET(bit, name, text, of_cpu, defined) \
  if (__builtin_cpu_supports(of_cpu)) there |= bit;
#include <zwang/bench/timing/instruction_sets.def>
#undef INSTRUCTION_SET
#else
  there = built_for;
#endif
  return there;
}

// Before the constructors of other sources, which may use anything.
__attribute__((constructor(101))) void look() {
  const std::string names = lacking(built_for, of_this_cpu());
  if (names.empty()) return;
  const std::string line = "This program was built for " + names +
                           ", which this CPU lacks: build it with -DZWANG_NATIVE=OFF and the flags of the oldest node "
                           "(docs/campaigns.md)\n";
  if (write(STDERR_FILENO, line.data(), line.size()) < 0) _exit(4);
  _exit(3);
}

}  // namespace

std::string lacking(unsigned wanted, unsigned there) {
  constexpr std::pair<unsigned, const char*> names[] = {
#define INSTRUCTION_SET(bit, name, text, ...) {bit, text},
#include <zwang/bench/timing/instruction_sets.def>
#undef INSTRUCTION_SET
  };
  std::string text;
  for (const auto& [bit, name] : names)
    if (wanted & ~there & bit) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

void check_instruction_set() {}

}  // namespace zwang
