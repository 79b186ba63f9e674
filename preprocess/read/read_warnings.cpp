#include "preprocess/read/read_warnings.h"

#include <algorithm>

namespace chamfer {

ReadWarnings::Entry* ReadWarnings::find(std::string_view kind) {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.kind == kind; });
  return found == entries_.end() ? nullptr : &*found;
}

void ReadWarnings::insert(std::string_view kind, const TextPlace& place, const std::string& what) {
  if (entries_.size() == kMost) {
    ++further_;
    return;
  }
  std::string text(place.file);
  if (place.line > 0) text = place.file.empty() ? "line " : text + ":";
  if (place.line > 0) text += std::to_string(place.line);
  if (!text.empty()) text += ": ";
  entries_.push_back({std::string(kind), text + what, 1});
}

std::vector<std::string> ReadWarnings::texts() const {
  std::vector<std::string> texts;
  for (const Entry& e : entries_)
    texts.push_back(e.text +
                    (e.count > 1 ? " (and " + std::to_string(e.count - 1) + " more of this kind)" : ""));
  if (further_ > 0) texts.push_back("and " + std::to_string(further_) + " more");
  return texts;
}

} // namespace chamfer
