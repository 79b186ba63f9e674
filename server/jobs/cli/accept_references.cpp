#include "server/jobs/cli/accept_references.h"

#include "common/atomic_file.h"
#include "common/error.h"
#include "common/text.h"

#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace chamfer {
namespace {

void replaceTexts(const std::filesystem::path& file, const std::map<std::string, std::string>& changes) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream whole;
  whole << stream.rdbuf();
  std::string text = whole.str();
  // All places are found before any text changes: one's new digest may be another's old one.
  std::map<std::size_t, std::pair<std::size_t, std::string>> places;
  for (const auto& [before, after] : changes)
    for (std::size_t at = text.find('"' + before + '"'); at != std::string::npos;
         at = text.find('"' + before + '"', at + 1))
      places[at + 1] = {before.size(), after};
  for (auto place = places.rbegin(); place != places.rend(); ++place)
    text.replace(place->first, place->second.first, place->second.second);
  writeAtomically(file, std::as_bytes(std::span(text)));
}

} // namespace

std::string acceptReferences(const std::vector<CaseChoice>& cases, const std::filesystem::path& suite,
                             CompareHost& host, const SuiteControl& control) {
  std::string told;
  std::map<std::string, std::string> digests; // before, after
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const CaseChoice& c = cases[i];
    if (c.b.isRender() || !c.a.isRender()) continue;
    CompareControl each = control.each;
    each.progress = [&, i](unsigned done, unsigned most) {
      if (control.progress) control.progress(i, done, most);
    };
    const std::string text = acceptCase(c, host, each);
    if (c.b.kind == SideKind::Digest) {
      const auto [known, isNew] = digests.emplace(c.b.text, text);
      if (!isNew && known->second != text)
        throw Error(ErrorKind::Usage, "several cases have the reference " + c.b.text +
                                          ", and their renders are no longer the same: write another digest "
                                          "(any will do) into each of them, and update again");
    }
    told += "accepted " + printable(c.name, 100) + ": " +
            (c.b.kind == SideKind::Digest && text == c.b.text ? "as it was" : printable(text, 200)) + '\n';
  }
  if (told.empty())
    throw Error(ErrorKind::Usage, "no case has a reference to update: a render as side a, and an image or a "
                                  "digest as side b");
  if (!digests.empty() && !suite.empty()) replaceTexts(suite, digests);
  return told;
}

bool rendersTwice(const std::vector<CaseChoice>& cases) {
  std::set<std::string> seen;
  for (const CaseChoice& c : cases)
    for (const SideChoice* side : {&c.a, &c.b})
      if (side->isRender() && !seen.insert(side->source + '|' + canonicalSettings(side->request)).second)
        return true;
  return false;
}

} // namespace chamfer
