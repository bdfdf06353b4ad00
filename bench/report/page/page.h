#pragma once

#include <string>
#include <string_view>

namespace zwang::report {

// A page of those embedded at build time with the data in its place: "run", "large" (of a run whose single ones stand
// in scripts beside it), "collision", "league". Throws std::invalid_argument for another name.
std::string page(std::string_view kind, const std::string& data);
// Any bundled page with its slot for data filled.
std::string filled(std::string_view page, const std::string& data);

}  // namespace zwang::report
