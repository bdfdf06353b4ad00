#pragma once

#include <string>
#include <vector>

#include <zwang/bench/report/results.h>

namespace zwang::report {

struct Cell {
  std::string text = {};
  double value = unknown;  // what .csv holds and sorting uses; NaN where the text is all there is
  std::string tone = {};   // "bad", "good", "warn" or ""

  Cell() = default;
  Cell(std::string shown, double number = unknown, std::string colour = "")
      : text(std::move(shown)), value(number), tone(std::move(colour)) {}
  Cell(const char* shown) : text(shown) {}
};

struct Column {
  std::string name;
  bool numeric = false;
};

struct Row {
  std::string solver = {}, group = {};  // what the chips and the family selector show and hide; "" stays
  std::vector<Cell> cells = {};
  std::string command = {};  // replays the row's run
};

// One table of the page, of a .csv and of a .tex file.
struct Table {
  std::string id, note = {};  // note: what the figures mean, or why there are none
  std::vector<Column> columns = {};
  std::vector<Row> rows = {};

  explicit Table(std::string name);  // with its columns of tables.json
  // Titles with "; " between them; "#" before one: a column of numbers.
  void add_columns(const std::string& titles);
  void add(std::string solver, std::string group, std::vector<Cell> cells, std::string command = "") {
    rows.push_back({std::move(solver), std::move(group), std::move(cells), std::move(command)});
  }
  // The note of tables.json under this name; "none" where there are no rows.
  void explain(const char* with_rows = "rows");
};

Table claim_counts_table(const RunFolder& run);  // false claims, counted by solver
Table claims_table(const RunFolder& run);        // every claim the referee rejects, false ones first
Table accuracy_table(const RunFolder& run);      // time at equal achieved error, per family and over all ("all")
Table means_table(const RunFolder& run);         // shifted geometric means, two shifts
Table break_point_table(
    const RunFolder& run);  // first failure / first false claim of each solver on each stability family
Table exponent_table(const RunFolder& run);    // fitted scaling exponents
Table verdict_table(const RunFolder& run);     // counts of claimed against verified, per solver
Table worst_row_table(const RunFolder& run);   // worst violated row per constraint type, among claims of success
Table range_gap_table(const RunFolder& run);   // |J k - c| / |c| against the error, where a solver reports it
Table reference_table(const RunFolder& run);   // where the true answers come from, per family
Table solver_table(const RunFolder& run);      // method and limits
Table conditions_table(const RunFolder& run);  // commit, compiler, CPU, libraries, seed
// Of the speed suite:
Table speed_table(const RunFolder& run);           // time, kernels, ratios, error and verdict per size and solver
Table speed_exponent_table(const RunFolder& run);  // time against the number of hands and of boxes
Table assembly_table(const RunFolder& run);
// Where there are such lines:
Table law_table(const RunFolder& run);          // one problem under several laws of friction
Table conformance_table(const RunFolder& run);  // which solver shows which phenomenon of friction
Table phenomenon_table(const RunFolder& run);   // what they are
Table sequence_table(const RunFolder& run);     // cold and warm over frames
Table recorded_table(const RunFolder& run);     // answers that came with the problems
// Per solver of both runs, on the problems both hold: what is reached at 1e-6, the time ratio, lies.
Table comparison_table(const RunFolder& a, const RunFolder& b);
// The page's tables, some only where there is something to say: those of all problems, and those of one class.
std::vector<Table> common_tables(const RunFolder& run);
std::vector<Table> class_tables(const RunFolder& of_class);

std::string knob_text(double value);  // "2^-27" for far powers of two, else "64" or "0.001"


}  // namespace zwang::report
