#pragma once

#include <string>

#include <zwang/bench/report/results.h>

namespace zwang::report {

// Rows of all charts as one JSON object {chart: {fields: [..], rows: [[..], ..]}}, aggregated so that a page draws at
// most 2,000 marks a chart; every single run stays in results.jsonl.
std::string chart_rows(const RunFolder& run);

}  // namespace zwang::report
