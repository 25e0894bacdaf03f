#include "core/scene/touching.h"

#include "core/scene/quadric_box.h"
#include "core/scene/touching_inset.h"
#include "core/scene/touching_passing.h"
#include "core/scene/touching_planes.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace lampyris {
namespace {

using glm::dvec3;

// The box of a box's corners.
PlaceBox transformed(const PlaceBox& box, const kernel::TransformRecord& t) {
    PlaceBox world = box;
    int axis = 0;
    for (const kernel::vec4& row : {t.to0, t.to1, t.to2}) {
        const glm::vec3 r(row), a = r * box.low, b = r * box.high;
        const glm::vec3 low = glm::min(a, b), high = glm::max(a, b);
        world.low[axis] = low.x + low.y + low.z + row.w, world.high[axis] = high.x + high.y + high.z + row.w;
        ++axis;
    }
    const glm::vec3 largest = glm::max(glm::abs(world.low), glm::abs(world.high));
    world.widen(1e-6 * double(std::max({largest.x, largest.y, largest.z})));  // its rounding
    return world;
}

// Kind, size and place of a sphere, disk or cylinder.
std::string quadric_key(const Scene& scene, const kernel::GeometryRecord& g) {
    std::string key(reinterpret_cast<const char*>(&g.kind), sizeof g.kind);
    key.append(reinterpret_cast<const char*>(&g.quadric), sizeof g.quadric);
    key.append(reinterpret_cast<const char*>(&scene.transforms[g.transform]), sizeof(kernel::TransformRecord));
    return key;
}

constexpr size_t kMostMessages = 10;
// Thousands of shapes in one place would take too long.
constexpr size_t kMostPairs = 20'000'000;
// The same for triangles whose boxes meet, most of which are in other planes.
constexpr size_t kMostNear = 100'000'000;
// Triangles that let light pass, of all instances.
constexpr size_t kMostInInstances = 2'000'000;

// Faces that touch are moved apart by this much more than what counts as the same place: 3e-6 of the coordinates, and the error of
// their planes.
constexpr double kGap = 1.25;
// No body is changed by more than this part of its size.
constexpr double kMostChange = 1e-3;

// The largest coordinate in the world of what an object with coordinates up to `largest` becomes, in the object's own lengths.
double reach_of_object(const Scene& scene, uint32_t set, double largest) {
    double most = 0.0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        if (scene.instance_sets[i] != set) continue;
        const kernel::TransformRecord& t = scene.instances[i].transform;
        double coordinate = 0.0, shrink = 0.0;
        for (const kernel::vec4& row : {t.to0, t.to1, t.to2})
            coordinate = std::max(coordinate, glm::length(dvec3(row)) * largest + std::abs(double(row.w)));
        for (const kernel::vec4& row : {t.from0, t.from1, t.from2}) shrink = std::max(shrink, glm::length(dvec3(row)));
        most = std::max(most, coordinate * shrink);
    }
    return most;
}

// The search, and what comes of it.
class Search {
 public:
    Search(BuildContext& context, const std::vector<Location>& places)
        : context_(context), scene_(context.scene), places_(places), passes_(scene_) {}

    // Shapes of one set among themselves.
    void within(uint32_t set_index) {
        const GeometrySet& set = scene_.sets[set_index];
        equal_quadrics(set);
        small_beside_spheres(set);
        if (set.geometry_count == 1 && is_one_body(set.first_geometry)) return;
        bool any = false;
        for (uint32_t g = set.first_geometry; g < set.first_geometry + set.geometry_count; ++g)
            any = any || passes_(scene_.geometries[g]);
        if (!any) return;
        double reach = 0.0;
        if (set_index != 0) {
            for_each_triangle(set, [&](const PlaneTriangle& t) { reach = std::max(reach, t.largest); });
            reach = reach_of_object(scene_, set_index, reach);
        }
        const auto seen = [reach](PlaneTriangle t) {
            t.largest = std::max(t.largest, reach);
            return t;
        };
        TriangleTree passing;
        for_each_triangle(set, [&](const PlaneTriangle& t) {
            if (passes_(scene_.geometries[t.geometry])) passing.add(seen(t), t.geometry);
        });
        if (passing.empty()) return;
        passing.build();
        for_each_triangle(set, [&](const PlaneTriangle& own) {
            const PlaneTriangle t = seen(own);
            const uint32_t skipped = is_one_body(t.geometry) ? t.geometry : TriangleTree::kNoGroup;
            passing.near(PlaceBox(t), skipped, [&](const TriangleTree::Entry& entry) {
                return meet(t, entry, [&] { return seen(plane_triangle(scene_, entry.geometry, entry.index)); });
            });
        });
    }

    // Bodies beside shapes of different instances, the world included. Instances of leaves, which are masked or thin, are too many.
    void across_instances() {
        if (scene_.instances.size() < 2) return;
        TriangleTree passing;
        for (uint32_t i = 0; i < scene_.instances.size(); ++i) {
            const GeometrySet& set = scene_.sets[scene_.instance_sets[i]];
            for (uint32_t g = set.first_geometry; g < set.first_geometry + set.geometry_count; ++g) {
                if (!passes_.is_boundary(scene_.geometries[g])) continue;
                if (passing.size() > kMostInInstances) return void(incomplete_ = true);
                for_each_triangle({g, 1}, [&](const PlaneTriangle& own) {
                    const PlaneTriangle t = in_world(scene_, own, i);
                    if (t.normal != dvec3(0.0)) passing.add(t, i);
                });
            }
        }
        if (passing.empty()) return;
        passing.build();
        for (uint32_t i = 0; i < scene_.instances.size(); ++i) {
            const std::optional<PlaceBox> box = box_of(i);
            // Nothing is near most instances.
            if (!box || passing.near(*box, i, [](const TriangleTree::Entry&) { return false; })) continue;
            for_each_triangle(scene_.sets[scene_.instance_sets[i]], [&](const PlaneTriangle& own) {
                const PlaneTriangle t = in_world(scene_, own, i);
                if (t.normal == dvec3(0.0)) return;
                passing.near(PlaceBox(t), i, [&](const TriangleTree::Entry& entry) {
                    return meet(t, entry, [&] {
                        return in_world(scene_, plane_triangle(scene_, entry.geometry, entry.index), entry.instance);
                    });
                });
            });
        }
    }

    void move() {
        for (auto& [geometry, inset] : insets_) inset.apply(scene_);
    }

    // For the user to know.
    void report() {
        size_t left = moved_.size();
        for (const auto& [pair, gap] : moved_) {
            if (moved_.size() - left == kMostMessages) break;
            --left;
            scene_.notes.push_back(fmt::format(
                "{} (Shape): a face lies on {}, where light passes: it is moved inwards by {:.1g}", where(pair.first),
                pair.first == pair.second ? "another one of it" : "one of the shape at " + where(pair.second), gap));
        }
        if (left > 0) scene_.notes.push_back(fmt::format("{} more shapes touch, and are moved as well", left));
        if (incomplete_)
            scene_.notes.push_back(
                "not all shapes were looked at for faces in the same place: there are too many of them");
    }

 private:
    template <typename Visit>
    void for_each_triangle(const GeometrySet& set, const Visit& visit) const {
        for (uint32_t g = set.first_geometry; g < set.first_geometry + set.geometry_count; ++g)
            for (uint32_t i = 0; i < plane_triangle_count(scene_.geometries[g]); ++i) {
                const PlaneTriangle t = plane_triangle(scene_, g, i);
                if (t.normal != dvec3(0.0)) visit(t);
            }
    }

    // Of an instance's triangles, in the world: the box of its set's box.
    std::optional<PlaceBox> box_of(uint32_t instance) {
        const uint32_t set = scene_.instance_sets[instance];
        const auto added = set_boxes_.try_emplace(set);
        std::optional<PlaceBox>& box = added.first->second;
        if (added.second)
            for_each_triangle(scene_.sets[set], [&box](const PlaneTriangle& t) {
                if (box)
                    box->add(PlaceBox(t));
                else
                    box = PlaceBox(t);
            });
        if (!box) return std::nullopt;
        return transformed(*box, scene_.instances[instance].transform);
    }

    // Whether a triangle and one that lets light pass, whose boxes meet, are in the same place. False to end the search.
    template <typename Triangle>
    bool meet(const PlaneTriangle& t, const TriangleTree::Entry& entry, const Triangle& triangle) {
        const bool one_mesh = t.geometry == entry.geometry && t.instance == entry.instance;
        if (++near_ > kMostNear) return !(incomplete_ = true);
        if (!entry.may_be_in_one_plane(t) || (one_mesh && !may_be_two_bodies(t, entry))) return true;
        if (++pairs_ > kMostPairs) return !(incomplete_ = true);
        if (told_.contains(std::minmax(t.geometry, entry.geometry))) return true;
        const PlaneTriangle other = triangle();
        if (in_one_plane(other, t) && overlap(other, t)) touch(t, other, one_mesh);
        return true;
    }

    // Of a mesh that is no body, triangles are not compared with each other.
    bool is_one_body(uint32_t geometry) {
        const auto [known, is_new] = one_body_.try_emplace(geometry, true);
        if (is_new && passes_.is_boundary(scene_.geometries[geometry]))
            known->second = !may_have_bodies(scene_, geometry);
        return known->second;
    }

    // Triangles of one mesh that have a vertex in common and the same outside go on from each other.
    bool may_be_two_bodies(const PlaneTriangle& t, const TriangleTree::Entry& entry) const {
        if (t.index == entry.index) return false;
        if (glm::dot(t.normal, dvec3(entry.normal)) < 0.0) return true;
        const std::array<size_t, 3> other = triangle_vertices(scene_, entry.geometry, entry.index);
        const auto shared = std::count_if(t.vertices.begin(), t.vertices.end(), [&](size_t v) {
            return std::find(other.begin(), other.end(), v) != other.end();
        });
        return shared == 0 || shared == 3;
    }

    // Curved shapes: those that are the same.
    void equal_quadrics(const GeometrySet& set) {
        std::map<std::string, uint32_t> first_of;
        for (uint32_t g = set.first_geometry; g < set.first_geometry + set.geometry_count; ++g) {
            const kernel::GeometryRecord& record = scene_.geometries[g];
            if (record.kind <= kernel::GEOMETRY_BILINEAR) continue;
            const auto [first, is_first] = first_of.try_emplace(quadric_key(scene_, record), g);
            if (!is_first && (passes_(record) || passes_(scene_.geometries[first->second])))
                warn(first->second, g, 0.0);
        }
    }

    // A ray that leaves a sphere starts outside of the rounding of its radius, and so inside of glass that is nearer. That of glass
    // in proportion to the sphere is next to nothing.
    void small_beside_spheres(const GeometrySet& set) {
        constexpr double kRounding = 2.5e-6, kSmall = 2e-4;  // of the radius
        const uint32_t end = set.first_geometry + set.geometry_count;
        std::vector<uint32_t> passing;
        double smallest = std::numeric_limits<double>::infinity();
        for (uint32_t g = set.first_geometry; g < end; ++g)
            if (passes_(scene_.geometries[g])) passing.push_back(g), smallest = std::min(smallest, size_of(g));
        for (uint32_t s = set.first_geometry; s < end; ++s) {
            const kernel::GeometryRecord& sphere = scene_.geometries[s];
            if (sphere.kind != kernel::GEOMETRY_SPHERE) continue;
            const kernel::TransformRecord& t = scene_.transforms[sphere.transform];
            const dvec3 middle(t.to0.w, t.to1.w, t.to2.w);
            const double radius = sphere.quadric.radius * glm::length(dvec3(t.to0.x, t.to1.x, t.to2.x));
            if (smallest > kSmall * radius) continue;
            for (const uint32_t g : passing) {
                if (++pairs_ > kMostPairs) return void(incomplete_ = true);
                if (g == s || size_of(g) > kSmall * radius) continue;
                const auto& [low, high] = boxes_.at(g);
                const double nearest = glm::length(middle - glm::clamp(middle, low, high)),
                             farthest = glm::length(glm::max(glm::abs(middle - low), glm::abs(middle - high)));
                if (std::max(nearest - radius, radius - farthest) > kRounding * radius) continue;
                if (!told_.insert(std::minmax(s, g)).second || told_.size() > kMostMessages) continue;
                context_.diagnostics.warning(
                    places_[g],
                    fmt::format("this shape is so small, and so close to the sphere at {}, that light which leaves the "
                                "sphere may start inside of it",
                                where(s)),
                    fmt::format("a gap of {:.1g} is enough, or a smaller sphere", kRounding * radius));
            }
        }
    }

    // `a` and `b` overlap in one plane.
    void touch(const PlaneTriangle& a, const PlaneTriangle& b, bool one_mesh) {
        const bool a_can = passes_.is_boundary(scene_.geometries[a.geometry]),
                   b_can = passes_.is_boundary(scene_.geometries[b.geometry]);
        // Of two bodies, one ends where the other begins: the later one gives way. If both are on the same side, nobody knows
        // which is to be inside of the other.
        const bool unclear = a_can && b_can && glm::dot(a.normal, b.normal) > 0.0;
        const double enough = kGap * same_place(a, b);
        if (unclear || (!a_can && !b_can)) return warn(a.geometry, b.geometry, enough);
        const auto order = [](const PlaneTriangle& t) { return std::tie(t.instance, t.geometry, t.index); };
        const bool a_moves = a_can && (!b_can || order(a) > order(b));
        const PlaneTriangle& moved = a_moves ? a : b;
        const PlaneTriangle& fixed = a_moves ? b : a;
        Inset& inset = insets_.try_emplace(moved.geometry, scene_, moved.geometry).first->second;
        // Bodies of one mesh have to be told apart, and moved apart.
        if (one_mesh && inset.bodies().of_triangle[moved.index] == inset.bodies().of_triangle[fixed.index])
            return warn(a.geometry, b.geometry, enough);
        const double gap = (kGap * same_place(a, b) + distance_from_plane(fixed, moved)) * moved.scale;
        const PlaneTriangle own = plane_triangle(scene_, moved.geometry, moved.index);
        if (inset.has(own, gap)) return;
        if (gap > kMostChange * size_of(moved.geometry)) return warn(a.geometry, b.geometry, enough);
        inset.add(own, gap, one_mesh);
        double& largest_gap = moved_[{moved.geometry, fixed.geometry}];
        largest_gap = std::max(largest_gap, gap);
    }

    void warn(uint32_t a, uint32_t b, double enough) {
        const auto pair = std::minmax(a, b);
        if (!told_.insert(pair).second || told_.size() > kMostMessages) return;
        context_.diagnostics.warning(
            places_[pair.second],
            fmt::format("a surface of this shape lies in the same place as {}, and light that passes through one of "
                        "them misses the other",
                        a == b ? "another one of it" : "one of the shape at " + where(pair.first)),
            enough > 0.0 ? fmt::format("a gap of {:.1g} is enough, or let the shapes overlap", enough)
                         : "a gap of 3e-6 of the coordinates is enough, or let the shapes overlap");
    }

    // The diagonal of a shape's box.
    double size_of(uint32_t geometry) {
        const auto [known, is_new] = boxes_.try_emplace(geometry, dvec3(1e300), dvec3(-1e300));
        dvec3 &low = known->second.first, &high = known->second.second;
        const auto add = [&](const dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); };
        const kernel::GeometryRecord& g = scene_.geometries[geometry];
        for (uint32_t i = 0; is_new && i < plane_triangle_count(g); ++i)
            for (const dvec3& p : plane_triangle(scene_, geometry, i).corners) add(p);
        if (is_new && g.kind > kernel::GEOMETRY_BILINEAR)
            for (const dvec3& p : quadric_corners(scene_, g)) add(p);
        return glm::length(high - low);
    }

    std::string where(uint32_t geometry) const { return context_.description.sources->describe(places_[geometry]); }

    BuildContext& context_;
    Scene& scene_;
    const std::vector<Location>& places_;
    Passing passes_;
    size_t pairs_ = 0, near_ = 0;
    bool incomplete_ = false;
    std::map<uint32_t, std::optional<PlaceBox>> set_boxes_;
    std::set<std::pair<uint32_t, uint32_t>> told_;
    std::map<std::pair<uint32_t, uint32_t>, double> moved_;  // geometry and the one that it touches; the gap
    std::map<uint32_t, Inset> insets_;
    std::map<uint32_t, std::pair<dvec3, dvec3>> boxes_;
    std::map<uint32_t, bool> one_body_;
};

}  // namespace

void separate_touching_surfaces(BuildContext& context, const std::vector<Location>& places) {
    Search search(context, places);
    for (uint32_t set = 0; set < context.scene.sets.size(); ++set) search.within(set);
    search.across_instances();
    search.move();
    search.report();
}

}  // namespace lampyris
