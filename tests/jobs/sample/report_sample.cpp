// Writes the HTML report of the made-up suite for the browser test, and to look at:
//   report_sample OUT.html [all | one | hostile | none]
#include "server/jobs/report/reports.h"

#include "tests/jobs/report_samples.h"

#include <fstream>
#include <iostream>
#include <string_view>

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: report_sample OUT.html [all | one | hostile | none]\n";
    return 2;
  }
  const std::string_view which = argc > 2 ? argv[2] : "all";
  chamfer::SuiteResult suite = chamfer::test::makeSuite();
  if (which == "one") suite.cases.resize(1);
  if (which == "hostile") suite.cases = {chamfer::test::makeHostileCase(), suite.cases[1]};
  if (which == "none") suite.cases.clear();
  std::ofstream out(argv[1], std::ios::binary);
  out << chamfer::comparisonHtml(suite);
  out.close();
  std::cout << chamfer::comparisonText(suite);
  return out ? 0 : 1;
}
