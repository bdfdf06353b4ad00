#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>

namespace zwang {

// The files in the folder of a run, and DIR/run.json, which every run keeps: how it is written, read back and compared
// with the program that would go on.
// A record is one JSON object.

// The conditions that decide the results and times of a run.
nlohmann::ordered_json fixed_conditions();

// `kind`: "run", "simulated run", for the message. Throws BadFile where there is no record, or none of JSON.
nlohmann::ordered_json load_record(const std::filesystem::path& directory, const std::string& kind);

// What `read` makes of the record in this folder. Whatever is wrong with its values is a BadFile, also where the same
// value typed as an option would be wrong use.
template <class Read>
auto from_record(const std::filesystem::path& directory, Read read) {
  try {
    return read();
  } catch (const BadFile&) {
    throw;
  } catch (const std::exception& wrong) {
    throw BadFile((directory / "run.json").string() + ": " + one_line(wrong.what()));
  }
}

// Replaces the file in one step: a killed run leaves the old one or the new one. Throws BadFile.
void replace_record(const std::filesystem::path& directory, const nlohmann::ordered_json& record);

// Throws BadFile when the run of this record was begun under other conditions; `therefore`: "its times would not
// compare". `any_cpu`: on whichever machine.
void require_same_conditions(const std::filesystem::path& directory, const nlohmann::ordered_json& record,
                             const std::string& therefore, bool any_cpu = false);

// Nobody else writes into the folder while this lives. Throws std::invalid_argument where another does.
std::shared_ptr<void> only_writer(const std::filesystem::path& directory);

// There is a record or results of any command in this folder.
bool holds_run(const std::filesystem::path& directory);

// "2026-11-20T23:54:03Z"
std::string now_iso8601();

// What names one cell of a suite, one solver on one problem at one tolerance: 32 hexadecimal digits, from the problem's
// place in the suite and its contents, the solver with its settings, and the commit of the program.
std::string cell_name(const std::string& commit, const std::string& problem_file, const std::string& problem_sha256,
                      const std::string& solver, double tolerance);

// "problems/0007.h5": the file of a suite's problem.
std::string problem_file(std::size_t position);

}  // namespace zwang
