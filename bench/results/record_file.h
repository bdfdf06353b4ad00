#pragma once

#include <filesystem>
#include <string>

namespace zwang {

// DIR/run.json, which every run keeps: how it is written, read back and held against the program that would go on.
// A record is the text of one JSON object.

// The conditions that decide the results and times of a run.
std::string fixed_conditions();

// `kind`: "run", "simulated run", for the message. Throws BadFile where there is no record, or none of JSON.
std::string load_record(const std::filesystem::path& directory, const std::string& kind);

// Replaces the file in one step: a killed run leaves the old one or the new one. Throws BadFile.
void replace_record(const std::filesystem::path& directory, const std::string& record);

// Throws std::invalid_argument when the run of this record was begun under other conditions; `therefore`: "its times
// would not compare".
void require_same_conditions(const std::filesystem::path& directory, const std::string& record,
                             const std::string& therefore);

// There is a record or results of any command in this folder.
bool holds_run(const std::filesystem::path& directory);

// "2026-11-20T23:54:03Z"
std::string now_iso8601();

}  // namespace zwang
