#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace zwang {

struct IsolationLimits {
  double seconds = 5;                        // CPU time; ten times that on the wall clock
  std::size_t bytes = std::size_t{1} << 30;  // memory, beyond what the process holds already
};

// Runs `work` in a forked process and returns what it returns there: a library that loops, crashes, prints or takes all
// the memory over a damaged file does so in that process. Throws BadFile, one line that names the file: what `work`
// threw, or that it crashed, did not end in time or asked for too much memory. (Under AddressSanitizer memory is not
// limited.)
std::string isolated(const std::filesystem::path& file, const IsolationLimits& limits,
                     const std::function<std::string()>& work);

}  // namespace zwang
