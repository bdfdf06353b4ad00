#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

namespace zwang {

struct IsolationLimits {
  double seconds = 5;                        // CPU time; ten times that on the wall clock
  std::size_t bytes = std::size_t{1} << 30;  // memory, beyond what the process holds already
};

// What a child process wrote, in memory that it shared.
class IsolatedAnswer {
 public:
  explicit IsolatedAnswer(int file);
  IsolatedAnswer(const IsolatedAnswer&) = delete;
  IsolatedAnswer& operator=(const IsolatedAnswer&) = delete;
  ~IsolatedAnswer();
  std::string_view bytes() const { return bytes_; }

 private:
  std::string_view bytes_;
};

// Runs `work` in a forked process and returns the bytes it writes there: a library that loops, crashes, prints or takes
// all the memory over a damaged file does so in that process. Throws BadFile, one line that names the file: what `work`
// threw, or that it crashed, did not end in time or asked for too much memory. (Under AddressSanitizer memory is not
// limited.)
using WriteAnswer = std::function<void(const void* data, std::size_t bytes)>;
IsolatedAnswer isolated(const std::filesystem::path& file, const IsolationLimits& limits,
                        const std::function<void(const WriteAnswer&)>& work);

}  // namespace zwang
