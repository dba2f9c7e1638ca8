// Tracing behind a window: what it ends with, and how soon it stops.
#include "live_render.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "../catch.hpp"
#include "comparison.hpp"
#include "hud_text.hpp"
#include "raylab/io/scene_file.hpp"

using namespace raylab;

namespace {

struct Cornell {
  LoadedScene loaded = load_scene(RAYLAB_SOURCE_DIR "/scenes/cornell.toml");
  AcceleratorShelf shelf{loaded.scene.geometry};

  TraceRequest request(int size, std::uint32_t samples) const {
    TraceRequest r;
    r.accel = "bvh";
    r.options.camera = loaded.camera;
    r.options.width = r.options.height = size;
    r.options.samples_per_pixel = samples;
    return r;
  }
};

/// `bvh` behind a gate: while it is closed, batches wait in it.
class Gate final : public Accelerator {
 public:
  Gate(const Geometry& geometry, const AcceleratorOptions& options)
      : behind_(make_accelerator("bvh", geometry, options)) {}
  std::optional<Hit> intersect(const Ray& ray) const noexcept override { return behind_->intersect(ray); }
  bool occluded(const Ray& ray) const noexcept override { return behind_->occluded(ray); }
  void intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept override {
    ++batches;
    closed.wait(true);
    behind_->intersect_batch(rays, hits);
  }
  const BuildReport& build_report() const noexcept override { return behind_->build_report(); }

  static inline std::atomic<bool> closed{false};
  static inline std::atomic<int> batches{0};  ///< that have come to the gate

 private:
  std::unique_ptr<Accelerator> behind_;
};
const RegisterAccelerator registered{{"gate", "for these tests", [](const Geometry& g, const AcceleratorOptions& o) {
                                        return std::make_unique<Gate>(g, o);
                                      }}};

template <class Condition>
bool eventually(const Condition& condition) {
  const Stopwatch watch;
  while (watch.seconds() < 60.0) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

}  // namespace

TEST_CASE("the still picture is that of a render session, bit for bit", "[unit][preview]") {
  Cornell cornell;
  TraceRequest request = cornell.request(60, 5);
  request.options.height = 40;
  request.options.camera.look_from.x += 10.0f;
  LiveRender live(cornell.loaded.scene, cornell.shelf);
  live.ask(cornell.request(80, 1000));
  const std::uint64_t number = live.ask(request);
  REQUIRE(eventually([&] { return live.latest() && live.latest()->request == number && live.latest()->complete; }));
  const auto picture = live.latest();
  CHECK(picture->samples == 5);

  const Scene& scene = cornell.loaded.scene;
  const auto accelerator = make_accelerator("bvh", scene.geometry);
  RenderSession session(scene, *accelerator, request.options);
  session.run();
  CHECK((picture->image.pixels == session.snapshot().image().pixels));
}

TEST_CASE("a snapshot for the display says what the film says", "[unit][preview]") {
  Cornell cornell;
  RenderOptions options = cornell.request(1, 1).options;
  options.width = 30;
  options.height = 21;  // not a whole number of the parts it is taken in
  options.samples_per_pixel = GENERATE(1u, 3u);
  options.crop = GENERATE(std::optional<PixelRect>(), PixelRect{3, 4, 20, 15});
  RenderSession session(cornell.loaded.scene, cornell.shelf.get("bvh"), options);
  session.run();
  Image coarse(2, 2);
  coarse.pixels = {Rgb(1, 0, 0), Rgb(2, 0, 0), Rgb(3, 0, 0), Rgb(4, 0, 0)};
  TracedPicture picture;
  take_snapshot(session, coarse, picture);
  const Film film = session.snapshot();
  Image expected = film.image();
  for (int y = 0; y < 21; ++y) {
    for (int x = 0; x < 30; ++x) {
      if (film.samples(x, y) == 0) expected.at(x, y) = coarse.at(x / 15, y * 2 / 21);
    }
  }
  CHECK((picture.image.pixels == expected.pixels));
  CHECK(picture.samples == (options.crop ? 0u : options.samples_per_pixel));
  if (options.samples_per_pixel == 1) {
    CHECK(picture.estimated_relmse == kInfinity);
  } else {
    CHECK(picture.estimated_relmse == Approx(session.estimated_error().relmse).epsilon(1e-12));
  }
}

TEST_CASE("a place in the window has the colour of the pixel shown there, whatever the picture's size",
          "[unit][preview]") {
  Image image(2, 2);
  image.pixels = {Rgb(1, 0, 0), Rgb(2, 0, 0), Rgb(3, 0, 0), Rgb(4, 0, 0)};
  CHECK(color_at(image, 20, 10, {0.0, 0.0}) == Rgb(1, 0, 0));
  CHECK(color_at(image, 20, 10, {10.0, 4.9}) == Rgb(2, 0, 0));
  CHECK(color_at(image, 20, 10, {9.9, 5.0}) == Rgb(3, 0, 0));
  CHECK(color_at(image, 20, 10, {19.9, 9.9}) == Rgb(4, 0, 0));
  for (const glm::dvec2 beside : {glm::dvec2(-0.1, 1.0), {1.0, -0.1}, {20.0, 1.0}, {1.0, 10.0}}) {
    CHECK_FALSE(color_at(image, 20, 10, beside));
  }
}

TEST_CASE("exposure brightens a picture by powers of two before it is encoded", "[unit][preview]") {
  Image image(1, 2);
  image.pixels = {Rgb(0.1f, 0.2f, 0.7f), Rgb(0.05f, 0.0f, 2.0f)};
  Image brighter = image;
  for (Rgb& pixel : brighter.pixels) pixel *= 2.0f;
  CHECK(encode_srgb(image, 1.0) == encode_srgb(brighter));
  CHECK(encode_srgb(brighter, -1.0) == encode_srgb(image));
}

TEST_CASE("a coarse picture comes first, then one that has a sample in every pixel", "[unit][preview]") {
  Cornell cornell;
  LiveRender live(cornell.loaded.scene, cornell.shelf);
  live.ask(cornell.request(400, 1u << 20));
  REQUIRE(eventually([&] { return live.latest() != nullptr; }));
  CHECK(live.latest()->samples == 0);
  CHECK(live.latest()->image.width < 400);
  REQUIRE(eventually([&] { return live.latest()->samples > 0; }));
  CHECK(live.latest()->image.width == 400);
  CHECK_FALSE(live.latest()->complete);
}

TEST_CASE("neither asking nor resting waits for what is traced, which then ends with the paths in hand",
          "[unit][preview]") {
  Cornell cornell;
  auto live = std::make_unique<LiveRender>(cornell.loaded.scene, cornell.shelf);
  TraceRequest request = cornell.request(300, 1u << 20);
  request.accel = "gate";
  live->ask(request);
  const bool traces = eventually([&] { return live->latest() && live->latest()->samples > 0; });
  const int one_pass = Gate::batches;  // and more
  Gate::closed = true;
  const int before = Gate::batches;
  CHECK(eventually([&] { return Gate::batches > before; }));
  // What is traced stands still: whoever waited for it now would wait for ever.
  request.options.camera.look_from.x += 1.0f;
  live->ask(request);
  live->rest();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // for the thread of the tracing to hear of it
  const int begun = Gate::batches;
  Gate::closed = false;
  Gate::closed.notify_all();
  live.reset();
  REQUIRE(traces);
  INFO("a pass takes " << one_pass << " batches at most");
  CHECK(Gate::batches - begun < one_pass / 4);
}

TEST_CASE("no accelerator's figures stand under another's name while the other's picture is on its way",
          "[unit][preview]") {
  Cornell cornell;
  LiveRender live(cornell.loaded.scene, cornell.shelf);
  const std::uint64_t number = live.ask(cornell.request(20, 3));
  REQUIRE(eventually([&] { return live.latest() && live.latest()->request == number && live.latest()->complete; }));
  CHECK(traced_text(live.latest().get(), "bvh", 3).at(0) == "3 of 3 samples a pixel, done");
  Gate::closed = true;
  TraceRequest request = cornell.request(20, 3);
  request.accel = "gate";
  live.ask(request);
  const std::vector<std::string> meanwhile = traced_text(live.latest().get(), "gate", 3);
  Gate::closed = false;
  Gate::closed.notify_all();
  REQUIRE(meanwhile.size() == 1);
  CHECK(meanwhile[0].find_first_of("0123456789") == std::string::npos);
  CHECK(meanwhile[0].find("that of bvh") != std::string::npos);
  REQUIRE(eventually([&] { return traced_text(live.latest().get(), "gate", 3).size() == 3; }));
}

TEST_CASE("each request is answered, whatever was asked before", "[unit][preview]") {
  Cornell cornell;
  LiveRender live(cornell.loaded.scene, cornell.shelf);
  for (int i = 0; i < 10; ++i) {
    TraceRequest request = cornell.request(300, 1u << 20);
    request.options.camera.look_from.x += static_cast<float>(i);
    const std::uint64_t number = live.ask(request);
    REQUIRE(eventually([&] { return live.latest() && live.latest()->request == number; }));
  }
}

TEST_CASE("tracing can end at any moment", "[unit][preview]") {
  Cornell cornell;
  for (int i = 0; i < 10; ++i) {
    LiveRender live(cornell.loaded.scene, cornell.shelf);
    live.ask(cornell.request(200, 1u << 20));
    std::this_thread::sleep_for(std::chrono::milliseconds(5 * i));
  }
}

TEST_CASE("what goes wrong while tracing is said", "[unit][preview]") {
  Cornell cornell;
  LiveRender live(cornell.loaded.scene, cornell.shelf);
  TraceRequest request = cornell.request(10, 1);
  request.options.camera.look_at = request.options.camera.look_from;
  live.ask(request);
  REQUIRE(eventually([&] { return !live.failure().empty(); }));
  CHECK(live.failure().find("look_at") != std::string::npos);
  const std::uint64_t number = live.ask(cornell.request(10, 1));
  REQUIRE(eventually([&] { return live.latest() && live.latest()->request == number && live.latest()->complete; }));
  CHECK(live.failure().empty());
}

TEST_CASE("two live renders share a scene", "[unit][preview]") {
  Cornell cornell;
  LiveRender a(cornell.loaded.scene, cornell.shelf);
  LiveRender b(cornell.loaded.scene, cornell.shelf);
  TraceRequest other = cornell.request(30, 2);
  other.accel = "list";
  other.options.camera.look_from.x += 50.0f;
  a.ask(cornell.request(30, 2));
  b.ask(other);
  REQUIRE(eventually([&] { return a.latest() && a.latest()->complete && b.latest() && b.latest()->complete; }));
  CHECK((a.latest()->image.pixels != b.latest()->image.pixels));
  other.options.camera = cornell.loaded.camera;
  const std::uint64_t number = b.ask(other);
  REQUIRE(eventually([&] { return b.latest()->request == number && b.latest()->complete; }));
  CHECK((a.latest()->image.pixels == b.latest()->image.pixels));
}

TEST_CASE("a comparison counts what two accelerators say of the camera rays", "[unit][preview]") {
  struct Blind : Accelerator {  // misses everything
    std::optional<Hit> intersect(const Ray&) const noexcept override { return std::nullopt; }
    bool occluded(const Ray&) const noexcept override { return false; }
    const BuildReport& build_report() const noexcept override { return report; }
    BuildReport report;
  };
  Cornell cornell;
  const Accelerator& bvh = cornell.shelf.get("bvh");
  const CameraSettings& camera = cornell.loaded.camera;
  const RayComparison none = compare_rays(bvh, cornell.shelf.get("list"), camera, 50, 40);
  CHECK(none.rays == 2000);
  CHECK(none.presence + none.distance + none.primitive + none.last_bits == 0);
  const RayComparison all = compare_rays(bvh, Blind(), camera, 200, 200);
  CHECK(all.presence > 32000);
  CHECK(all.presence < 40000);  // the box does not fill the picture
  CHECK(all.picture.at(100, 100) == Rgb(1.0f, 0.0f, 0.0f));
  CHECK(all.picture.at(0, 0) == none.picture.at(0, 0));
}

TEST_CASE("the one ray of a picture that meets nothing in one accelerator can be seen among blue ones",
          "[unit][preview]") {
  /// `bvh`, but for a last bit of every t, and for one ray: that through the middle of a pixel.
  struct NearlyRight : Accelerator {
    const Accelerator* right = nullptr;
    vec3 wrong;  // direction
    std::optional<Hit> intersect(const Ray& ray) const noexcept override {
      std::optional<Hit> hit = right->intersect(ray);
      if (ray.direction == wrong) return std::nullopt;
      if (hit) hit->t = std::nextafter(hit->t, 0.0f);
      return hit;
    }
    bool occluded(const Ray& ray) const noexcept override { return right->occluded(ray); }
    const BuildReport& build_report() const noexcept override { return right->build_report(); }
  };
  Cornell cornell;
  const Accelerator& bvh = cornell.shelf.get("bvh");
  NearlyRight other;
  other.right = &bvh;
  const int x = GENERATE(20, 48);
  other.wrong = Camera(cornell.loaded.camera, 50, 50).ray(static_cast<float>(x) + 0.5f, 25.5f, vec2(0.5f)).direction;
  const RayComparison compared = compare_rays(bvh, other, cornell.loaded.camera, 50, 50);
  CHECK(compared.presence == 1);
  CHECK(compared.last_bits > 2000);
  const Rgb red(1.0f, 0.0f, 0.0f), blue = compared.picture.at(25, 10);
  CHECK(blue.b > blue.r);
  CHECK(luminance(blue) < 0.1f);
  int reds = 0;
  for (const Rgb& pixel : compared.picture.pixels) reds += pixel == red;
  CHECK(reds == (x == 20 ? 49 : 7 * 5));
  CHECK(compared.picture.at(x, 25) == red);
}
