#pragma once

#include <string>

namespace zwang::report {

// replay.html, bundled at build time, with its data (one JSON object, docs/god-hand.md) in its place.
std::string replay_page(const std::string& data);

}  // namespace zwang::report
