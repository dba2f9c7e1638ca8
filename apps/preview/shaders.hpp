#pragma once
// The raster view's shaders, GLSL 3.30. Positions are relative to the eye, so that scenes far from the origin do
// not tremble.
namespace raylab::shaders {

// What surfaces look like under a lamp at the eye and a sky above: no light transport, but every kind of material
// can be told from the others. Four texels hold one material, see raster_view.cpp.
inline constexpr const char* kSurface = R"(#version 330 core
uniform samplerBuffer materials;
uniform sampler2D picture;
uniform sampler2D sky_picture;
uniform int sky_kind;        // 0 constant, 1 gradient, 2 picture
uniform vec3 sky_bottom, sky_top;
uniform vec3 eye, up, ahead;
out vec4 fragment;

const float pi = 3.14159265;

vec3 srgb(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
vec3 sky(vec3 d) {
  if (sky_kind == 0) return sky_bottom;
  if (sky_kind == 1) return mix(sky_bottom, sky_top, 0.5 * d.y + 0.5);
  vec2 at = vec2(atan(d.x, -d.z) / (2.0 * pi) + 0.5, acos(clamp(d.y, -1.0, 1.0)) / pi);
  return textureLod(sky_picture, at, 0.0).rgb;
}
// What mirrors show: the sky, and a studio where it is dark, for a black mirror tells nothing.
vec3 mirrored(vec3 d, float blur) {
  float h = dot(d, up);
  float edge = 0.03 + 0.6 * blur;
  vec3 studio = mix(vec3(0.10), vec3(0.85), smoothstep(-edge, edge, h)) * (1.0 - 0.35 * smoothstep(0.2, 1.0, h));
  vec3 s = sky(d);
  return mix(studio, s, clamp(dot(s, vec3(0.4)), 0.0, 0.7));
}
vec3 base_color(vec4 a, vec4 b, vec4 c, vec3 p, vec2 uv, bool exact_level) {
  if (b.w == 0.0) return a.rgb;
  if (b.w == 1.0) {
    vec3 cell = floor((p + eye) / c.z);
    return mod(cell.x + cell.y + cell.z, 2.0) == 0.0 ? a.rgb : b.rgb;
  }
  vec2 at = vec2(uv.x, 1.0 - uv.y);
  return exact_level ? textureLod(picture, at, 0.0).rgb : texture(picture, at).rgb;
}
// p relative to the eye, n facing the eye.
vec4 surface(int material, vec3 p, vec3 n, vec2 uv, bool exact_level) {
  vec4 a = texelFetch(materials, 3 * material), b = texelFetch(materials, 3 * material + 1),
       c = texelFetch(materials, 3 * material + 2);
  vec3 color = base_color(a, b, c, p, uv, exact_level);
  vec3 v = -normalize(p);
  float facing = clamp(dot(n, v), 0.0, 1.0);
  vec3 r = reflect(-v, n);
  if (a.w == 0.0) return vec4(srgb(color * (0.22 + 0.48 * facing + 0.15 * (1.0 + dot(n, up)))), 1.0);
  if (a.w == 1.0) {
    float shine = pow(max(dot(r, v), 0.0), mix(400.0, 6.0, sqrt(c.x))) * (1.0 - 0.7 * c.x);
    return vec4(srgb(color * (mirrored(r, c.x) * mix(1.0, 0.45 + 0.55 * facing, c.x) + shine)), 1.0);
  }
  if (a.w == 2.0) {
    float f0 = pow((c.y - 1.0) / (c.y + 1.0), 2.0);
    float rim = f0 + (1.0 - f0) * pow(1.0 - facing, 4.0);
    float shine = pow(max(dot(r, v), 0.0), 300.0);
    vec3 tint = vec3(0.55, 0.75, 0.80);
    return vec4(srgb(mix(tint * 0.6, mirrored(r, 0.0), rim) + shine), clamp(0.25 + 0.75 * rim + shine, 0.0, 1.0));
  }
  // Lights keep their hue: the brightest channel is white's.
  return vec4(srgb(color / max(max(color.r, max(color.g, color.b)), 1.0)), 1.0);
}
)";

inline constexpr const char* kMeshVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 texcoord;
uniform mat4 clip_from_view;  // of positions relative to the eye
uniform vec3 eye;
out vec3 p, n;
out vec2 uv;
void main() {
  p = position - eye;
  n = normal;
  uv = texcoord;
  gl_Position = clip_from_view * vec4(p, 1.0);
}
)";

inline constexpr const char* kMeshFragment = R"(
uniform int material;
in vec3 p, n;
in vec2 uv;
void main() {
  vec3 ns = dot(n, n) > 0.0 ? normalize(n) : normalize(cross(dFdx(p), dFdy(p)));
  fragment = surface(material, p, dot(ns, p) > 0.0 ? -ns : ns, uv, false);
}
)";

// A rectangle that covers the sphere; the fragment shader finds the sphere in it, exact at any size.
inline constexpr const char* kSphereVertex = R"(#version 330 core
layout(location = 0) in vec4 sphere;  // centre, radius
layout(location = 1) in int material_id;
uniform mat4 clip_from_view;
uniform vec3 eye, ahead;
flat out vec4 ball;
flat out int material;
void main() {
  ball = vec4(sphere.xyz - eye, sphere.w);
  material = material_id;
  vec2 low = vec2(1.0), high = vec2(-1.0);
  bool crosses = false;
  for (int i = 0; i < 8; ++i) {
    vec3 corner = ball.xyz + ball.w * (vec3(i & 1, (i >> 1) & 1, i >> 2) * 2.0 - 1.0);
    if (dot(corner, ahead) <= 0.0) crosses = true;
    vec4 c = clip_from_view * vec4(corner, 1.0);
    low = min(low, c.xy / c.w);
    high = max(high, c.xy / c.w);
  }
  if (crosses) { low = vec2(-1.0); high = vec2(1.0); }
  low = max(low, vec2(-1.0));
  high = min(high, vec2(1.0));
  bool behind = dot(ball.xyz, ahead) + ball.w * 1.7320508 <= 0.0;
  vec2 at = mix(low, high, vec2(gl_VertexID & 1, gl_VertexID >> 1));
  gl_Position = behind ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(at, 0.5, 1.0);
}
)";

inline constexpr const char* kSphereFragment = R"(
uniform vec3 right, above;  // reach the edge of the picture one unit ahead
uniform vec2 size;          // pixels
uniform float nearest;
uniform vec2 depth;         // of t ahead: x + y / t
flat in vec4 ball;
flat in int material;
void main() {
  vec2 at = gl_FragCoord.xy / size * 2.0 - 1.0;
  vec3 d = ahead + at.x * right + at.y * above;
  float a = dot(d, d), b = dot(ball.xyz, d);
  vec3 off = ball.xyz - (b / a) * d;
  float beyond = ball.w * ball.w - dot(off, off);
  if (beyond < 0.0) discard;
  float root = sqrt(beyond / a);
  float distance2 = (length(ball.xyz) - ball.w) * (length(ball.xyz) + ball.w);
  // The root without cancellation first, for ground spheres of radius 1000.
  float far_t = b / a + root;
  float t = b > 0.0 ? distance2 / (a * far_t) : b / a - root;
  if (t < nearest) t = far_t;
  if (t < nearest) discard;
  vec3 p = t * d;
  vec3 n = normalize(p - ball.xyz);
  vec2 uv = vec2((atan(-n.z, n.x) + pi) / (2.0 * pi), acos(clamp(-n.y, -1.0, 1.0)) / pi);
  fragment = surface(material, p, dot(n, p) > 0.0 ? -n : n, uv, true);
  gl_FragDepth = clamp(depth.x + depth.y / t, 0.0, 1.0);
}
)";

// One triangle that covers all.
inline constexpr const char* kScreenVertex = R"(#version 330 core
out vec2 at;  // [-1, 1], up
void main() {
  at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(at, 0.0, 1.0);
}
)";

inline constexpr const char* kSkyFragment = R"(
uniform vec3 right, above;
in vec2 at;
void main() { fragment = vec4(srgb(sky(normalize(ahead + at.x * right + at.y * above))), 1.0); }
)";

inline constexpr const char* kPlaneVertex = R"(#version 330 core
uniform mat4 clip_from_view;
uniform vec3 ahead, right, above;
uniform float distance;
out vec2 at;
void main() {
  at = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  at *= 0.9;
  gl_Position = clip_from_view * vec4(distance * (ahead + at.x * right + at.y * above), 1.0);
}
)";

// Colour and cover of the focus plane, which faces the eye and reaches to nine tenths of the picture.
inline constexpr const char* kPlaneColor = R"(#version 330 core
vec4 plane_color(vec2 at) {
  vec2 line = abs(fract(at * 5.0 / 0.9 * 0.5) - 0.5);
  bool edge = max(abs(at.x), abs(at.y)) > 0.885;
  bool grid = min(line.x, line.y) < 0.006;
  return edge ? vec4(1.0, 0.85, 0.2, 0.9) : vec4(0.25, 0.55, 1.0, grid ? 0.6 : 0.32);
}
)";

inline constexpr const char* kPlaneFragment = R"(
in vec2 at;
out vec4 fragment;
void main() { fragment = plane_color(at); }
)";

// The same over a picture. A program of its own: what is not shown costs a frame nothing.
inline constexpr const char* kPlaneOverFragment = R"(
uniform sampler2D depth_picture;  // of the first surface
uniform float plane_depth;
in vec2 at;
out vec4 fragment;
void main() {
  vec2 uv = vec2(0.5 * at.x + 0.5, 0.5 - 0.5 * at.y);
  if (max(abs(at.x), abs(at.y)) > 0.9 || texture(depth_picture, uv).r <= plane_depth) discard;
  fragment = plane_color(at);
}
)";

inline constexpr const char* kPictureFragment = R"(#version 330 core
uniform sampler2D left_picture, right_picture;
uniform float divider;   // of the width; 1: the left picture alone
uniform float line;      // half the width of the line between them
in vec2 at;
out vec4 fragment;
void main() {
  vec2 uv = vec2(0.5 * at.x + 0.5, 0.5 - 0.5 * at.y);
  vec3 color = uv.x < divider ? texture(left_picture, uv).rgb : texture(right_picture, uv).rgb;
  if (divider > 0.0 && divider < 1.0 && abs(uv.x - divider) < line) color = vec3(1.0, 0.85, 0.2);
  fragment = vec4(color, 1.0);
}
)";

}  // namespace raylab::shaders
