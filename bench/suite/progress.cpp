#include <zwang/bench/suite/progress.h>

#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdio>

namespace zwang {

std::string duration(double seconds) {
  if (seconds < 0.9995) return std::to_string(std::lround(seconds * 1e3)) + " ms";
  const long s = std::lround(seconds);
  if (s < 60) return std::to_string(s) + " s";
  if (s < 3600) return std::to_string(s / 60) + " min " + std::to_string(s % 60) + " s";
  return std::to_string(s / 3600) + " h " + std::to_string(s % 3600 / 60) + " min";
}

Progress::Progress() : terminal_(isatty(STDERR_FILENO) == 1) {}

void Progress::show(double fraction, const std::string& what, std::optional<double> given) {
  const double now = wall_seconds();
  if (fraction < before_) begun_ = fraction, since_ = now;
  before_ = fraction;
  const double left = given ? *given : fraction > begun_ ? (now - since_) * (1 - fraction) / (fraction - begun_) : -1;
  const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
  const std::string rest = left < 0 ? "" : duration(std::max(left, 1.0)) + " left";
  if (!terminal_) {
    if (percent / 10 <= tenths_) return;
    tenths_ = percent / 10;
    std::fprintf(stderr, "%d %%   %s\n", tenths_ * 10, rest.c_str());
    return;
  }
  // Ten frames a second: drawing must not compete with what is timed.
  if (now - last_ < 0.1) return;
  last_ = now;
  drawn_ = true;
  winsize window{};
  const int width = ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0 ? window.ws_col : 80;
  std::string bar(26, ' ');
  const auto filled = static_cast<std::size_t>(percent * 26 / 100);
  std::fill_n(bar.begin(), filled, '=');
  if (filled < bar.size()) bar[filled] = '>';
  const std::string head = printed("[%s] %3d %%   ", bar.c_str(), percent);
  // On a narrow terminal the description is cut first.
  const int room = width - 1 - static_cast<int>(head.size() + rest.size()) - 3;
  const std::string middle = room > 0 ? what.substr(0, static_cast<std::size_t>(room)) + "   " : "";
  std::fprintf(stderr, "\r%s%s%s\033[K", head.c_str(), middle.c_str(), rest.c_str());
}

void Progress::clear() {
  if (drawn_) std::fprintf(stderr, "\r\033[K");
  drawn_ = false;
}

}  // namespace zwang
