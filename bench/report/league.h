#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace zwang::report {

// The page of a league, of records: folders with entry.json and, in a folder a pack, what `judge` wrote
// (docs/league.md). The same bytes for the same records, in whatever order and wherever they lie. Throws BadFile: a
// record that lacks something, two of one solver and version, packs of one name that hold other problems.
std::string league_page(const std::vector<std::filesystem::path>& records);

}  // namespace zwang::report
