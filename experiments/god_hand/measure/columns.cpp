#include <zwang/experiments/god_hand/measure/columns.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace zwang::god {

constexpr std::array all_columns = {
    Column{"t", "s", &Frame::time},
    Column{"gap", "m", &Frame::gap},
    Column{"depth", "m", &Frame::target_depth},
    Column{"joint", "m", &Frame::separation},
    Column{"limit", "rad", &Frame::limit},
    Column{"dist", "m", &Frame::distance},
    Column{"slide", "m", &Frame::lost_slide},
    Column{"jitter", "m", &Frame::jitter},
    Column{"work", "J", &Frame::work},
    Column{"impulse", "1", &Frame::impulse_error},
    Column{"speed", "m/s", &Frame::object_speed},
    Column{"grip", "N", &Frame::grip},
    Column{"friction", "1", &Frame::friction_used},
    Column{"slip", "m/s", &Frame::slip},
    Column{"creep", "m/s", &Frame::creep},
    Column{"late", "s", &Frame::late},
    Column{"rows", "1", &Frame::rows},
    Column{"raw", "1", &Frame::raw},
    Column{"kept", "1", &Frame::kept},
    Column{"completed", "1", &Frame::completed},
    Column{"sub", "1", &Frame::sub_steps},
    Column{"returned", "1", &Frame::returned},
    Column{"tracked", "1", &Frame::tracked},
    Column{"held", "1", &Frame::held},
    Column{"stuck", "1", &Frame::stuck},
    Column{"behind", "1", &Frame::behind},
    Column{"origin", "1", &Frame::origin},
};

std::span<const Column> columns() { return all_columns; }

std::array<double, 6> stages(const StageTimes& t) {
  return {t.physics, t.resolution, t.assembly, t.solve, t.collision(), t.other};
}

Totals::Totals() {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  ranges_.assign(all_columns.size(), {none, none, 0});
}

void Totals::add(const Frame& frame) {
  for (std::size_t k = 0; k < ranges_.size(); ++k) {
    const double x = all_columns[k].of(frame);
    Range& range = ranges_[k];
    range.least = std::fmin(range.least, x);
    range.most = std::fmax(range.most, x);
    if (!std::isnan(x)) range.sum += x;
  }
  ++frames_;
  touching_ += frame.touches();
}

const Totals::Range& Totals::of(std::string_view key) const {
  for (std::size_t k = 0; k < ranges_.size(); ++k)
    if (all_columns[k].key == key) return ranges_[k];
  throw std::logic_error("no column '" + std::string(key) + "' in a frame");
}

}  // namespace zwang::god
