// Comparisons in the server: scenes of its catalogue, files below the served folder, renders in the
// background.
#pragma once

#include "server/http/routes/routes.h"
#include "server/jobs/compare/compare_host.h"

#include <functional>
#include <map>
#include <string>

namespace chamfer::http {

/// What a job's inputs were when it was submitted, by the names that its sides have for them.
struct JobOrigins {
  std::map<std::string, std::string> scenes; ///< ids
  std::map<std::string, std::string> files;  ///< digests of images' and masks' bytes
};

/// The scene that a side names: by its name or id, or as the command line names its file. nullptr: there is
/// none.
std::shared_ptr<const CatalogueEntry> findScene(const Catalogue& catalogue, const std::string& source);
/// An image or mask below the served folder. Error(NotFound), Error(Malformed): none, a hidden one, one that
/// leads out; Error(PayloadTooLarge). Messages carry `name` only.
std::filesystem::path servedFile(const std::filesystem::path& root, const std::string& name);
/// Of the file's bytes, hexadecimal.
std::string fileDigest(const std::filesystem::path& file);

class ServedHost final : public CompareHost {
public:
  /// `stop`: asked often, from any thread; true: Error(Cancelled).
  ServedHost(const Parts& parts, const JobOrigins& origins, std::function<bool()> stop)
      : parts_(parts), origins_(origins), stop_(std::move(stop)) {}

  /// Waits while it is being loaded. An Error where it is no longer what it was at submission.
  std::shared_ptr<const Scene> scene(const SideChoice& side) override;
  /// The same of a file.
  std::filesystem::path file(const std::string& name) override;
  /// Tile by tile, each through the queue's place for work in the background.
  RenderResult render(const std::shared_ptr<const Scene>& scene, const TileRequest& request) override;

private:
  std::shared_ptr<const PreparedScene> prepared(const std::shared_ptr<const Scene>& scene,
                                                const RoundingChoice& choice) const;
  void pause() const;

  const Parts& parts_;
  const JobOrigins& origins_;
  std::function<bool()> stop_;
};

} // namespace chamfer::http
