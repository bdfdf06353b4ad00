#pragma once

#include <string>
#include <vector>

namespace zwang {

// "; did you mean 'tower'?" for the name with the smallest edit distance, or "" when none is near.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& names);

}  // namespace zwang
