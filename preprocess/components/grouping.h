// Sets of things as lists.
#pragma once

#include "common/rounding.h"
#include "preprocess/core/polytope.h"

namespace chamfer {

/// The numbers 0 .. count-1, listed by the set that setOf(i) names (below `sets`); lists in order of their
/// first member, members ascending.
template <class SetOf>
Lists listsBy(std::size_t count, std::size_t sets, SetOf setOf) {
  std::vector<std::uint32_t> listOfSet(sets, kNone), listOf(count);
  Lists lists;
  lists.start.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t& list = listOfSet[setOf(i)];
    if (list == kNone) {
      list = std::uint32_t(lists.start.size());
      lists.start.push_back(0);
    }
    listOf[i] = list;
    ++lists.start[list];
  }
  lists.start.push_back(0);
  std::uint32_t sum = 0; // the ends, which filling from behind turns into the starts
  for (std::uint32_t& s : lists.start)
    s = sum += s;
  lists.items.resize(count);
  for (std::uint32_t i = std::uint32_t(count); i-- > 0;)
    lists.items[--lists.start[listOf[i]]] = i;
  return lists;
}

} // namespace chamfer
