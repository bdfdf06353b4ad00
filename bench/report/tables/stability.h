#pragma once

#include <span>
#include <string_view>

namespace zwang::report {

// A family of the stability atlas, in words (docs/stability.md says more).
struct StabilityFamily {
  std::string_view name, knob;
  std::string_view shows;  // what the family is, what it shows, and why methods fail on it
};

std::span<const StabilityFamily> stability_families();

}  // namespace zwang::report
