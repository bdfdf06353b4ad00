#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <regex>
#include <string_view>
#include <utility>

#include <zwang/bench/report/tables/tables.h>
#include <zwang/bench/report/wording.h>

namespace zwang::report {
namespace {

// Of LaTeX's article class at 10 pt [pt]: a column of two, the text in one; and our type, with what parts two columns.
constexpr double column_of_two = 229, whole_text = 345, type = 8, gap = 6;
constexpr double page_lines = 45;  // lines of our type, below a caption

const std::regex before_a_knob("(,|:|\\w\\()(?=[a-z])");  // where a name may be broken

// Our texts are ASCII; what TeX reads as commands is escaped, the backslash first.
std::string tex_text(std::string text) {
  static const std::pair<std::regex, const char*> rules[] = {{std::regex("\\\\"), "\\textbackslash "},
                                                             {std::regex("[_%&#${}]"), "\\$&"},
                                                             {std::regex("\\^(-?[0-9]+)"), "$$^{$1}$$"},
                                                             {std::regex("\\^(?!\\{)"), "\\^{}"},
                                                             {std::regex("\\|"), "$$|$$"},
                                                             {std::regex("<="), "$$\\le$$"},
                                                             {std::regex("[<>]"), "$$$&$$"},
                                                             {std::regex(" us\\b"), " $$\\mu$$s"},
                                                             {before_a_knob, "$&\\allowbreak "}};
  for (const auto& [what, by] : rules) text = std::regex_replace(text, what, by);
  return text;
}

// In Computer Modern, seldom less than it is [pt].
double width(const std::string& text) {
  static const std::string_view narrow = " .,:;'|()[]-_!Ifijlrt", wide = "mw%=+<>";
  double sum = 0;
  for (const char c : text) {
    const bool is_wide = std::isupper(c) || wide.find(c) != wide.npos;
    sum += type * (narrow.find(c) != narrow.npos ? 0.41 : is_wide ? 0.85 : std::isdigit(c) ? 0.54 : 0.59);
  }
  return sum;
}

// A column's words, which are not broken, and its texts.
struct Widest {
  double word = 0, text = 0;

  void take(const std::string& line) {
    text = std::max(text, width(line));
    for (const std::string& part : split(std::regex_replace(line, before_a_knob, "$& "), ' '))
      word = std::max(word, width(part));
  }
};

// Columns that stand side by side.
struct ColumnBlock {
  std::vector<std::size_t> columns;
  std::vector<double> widths;  // [pt]
  bool breaks = false;         // texts have several lines

  double whole() const { return std::accumulate(widths.begin(), widths.end(), gap * std::size(widths)); }
};

// The widest columns give way until all have room, at most to their longest words.
ColumnBlock side_by_side(const std::vector<std::size_t>& columns, const std::vector<Widest>& widest) {
  ColumnBlock block{columns, {}};
  double most = 0;
  for (const std::size_t c : columns) {
    block.widths.push_back(widest[c].text);
    most = std::max(most, widest[c].text);
  }
  for (block.breaks = block.whole() > whole_text; block.whole() > whole_text && most > 0; --most)
    for (std::size_t i = 0; i < columns.size(); ++i)
      block.widths[i] = std::max(widest[columns[i]].word, std::min(widest[columns[i]].text, most));
  return block;
}

// One block where the words of all columns have room; else several, each with what names the rows: the columns before
// the first numbers.
std::vector<ColumnBlock> blocks_of(const std::vector<Column>& columns, const std::vector<Widest>& widest) {
  std::size_t names = static_cast<std::size_t>(std::ranges::find(columns, true, &Column::numeric) - columns.begin());
  if (names == columns.size()) names = 1;
  std::vector<std::size_t> chosen(names);
  std::iota(chosen.begin(), chosen.end(), 0);
  std::vector<ColumnBlock> blocks;
  for (std::size_t c = names; c < columns.size(); ++c) {
    chosen.push_back(c);
    if (side_by_side(chosen, widest).whole() <= whole_text || chosen.size() == names + 1) continue;
    chosen.pop_back();
    blocks.push_back(side_by_side(chosen, widest));
    chosen.resize(names);
    chosen.push_back(c);
  }
  blocks.push_back(side_by_side(chosen, widest));
  return blocks;
}

std::string specification(const Table& table, const ColumnBlock& block) {
  std::string out;
  for (std::size_t i = 0; i < block.columns.size(); ++i) {
    const bool numeric = table.columns[block.columns[i]].numeric;
    out += !block.breaks ? numeric ? "r" : "l"
                         : printed(">{\\ragged%s\\arraybackslash}p{%.0fpt}", numeric ? "left" : "right",
                                   std::floor(block.widths[i]));
  }
  return out;
}

// "a & b \\".
std::string line_of(const ColumnBlock& block, const auto& text_at) {
  std::vector<std::string> fields;
  for (const std::size_t c : block.columns) fields.push_back(tex_text(text_at(c)));
  return joined(fields, " & ") + " \\\\\n";
}

}  // namespace

std::string to_tex(const Table& table) {
  std::vector<Widest> widest(table.columns.size());
  for (std::size_t c = 0; c < widest.size(); ++c) {
    widest[c].take(table.columns[c].name);
    for (const Row& row : table.rows) widest[c].take(row.cells[c].text);
  }
  const std::vector<ColumnBlock> blocks = blocks_of(table.columns, widest);
  double lines = 0, whole = 0;
  for (const ColumnBlock& block : blocks) {
    whole = std::max(whole, block.whole());
    for (const Row& row : table.rows) {
      double most = 1;
      for (std::size_t i = 0; i < block.columns.size(); ++i)
        most = std::max(most, std::ceil(width(row.cells[block.columns[i]].text) / (block.widths[i] + 1)));
      lines += most;
    }
  }
  const bool is_long = lines > page_lines;
  const std::string environment = is_long ? "longtable" : whole > column_of_two ? "table*" : "table";
  const std::string caption = "\\caption{" + tex_text(table.note) + "}\n\\label{tab:zwang-" + table.id + "}";
  const std::string small =
      printed("\\fontsize{%g}{%g}\\selectfont\n\\setlength{\\tabcolsep}{%gpt}\n", type, 1.2 * type, gap / 2);

  std::string out =
      "% \\usepackage{array,booktabs" + std::string(is_long ? ",longtable}; after \\onecolumn" : "}") + "\n";
  out += is_long ? "\\begingroup\n" + small + "\\setlength{\\LTcapwidth}{\\textwidth}\n"
                 : "\\begin{" + environment + "}\n\\centering\n" + caption + "\n\\smallskip\n" + small;
  for (const ColumnBlock& block : blocks) {
    const bool first = &block == &blocks.front();
    const std::string head =
        "\\toprule\n" + line_of(block, [&](std::size_t c) { return table.columns[c].name; }) + "\\midrule\n";
    if (!first) out += is_long ? "\\addtocounter{table}{-1}\n" : "\n\\medskip\n";
    out += "\\begin{" + std::string(is_long ? "longtable" : "tabular") + "}{" + specification(table, block) + "}\n";
    if (is_long && first) out += caption + "\\\\\n" + head + "\\endfirsthead\n";
    out += head + (is_long ? "\\endhead\n\\bottomrule\n\\endfoot\n" : "");
    for (const Row& row : table.rows) out += line_of(block, [&](std::size_t c) { return row.cells[c].text; });
    out += is_long ? "\\end{longtable}\n" : "\\bottomrule\n\\end{tabular}\n";
  }
  return out + (is_long ? "\\endgroup\n" : "\\end{" + environment + "}\n");
}

}  // namespace zwang::report
