#pragma once
// OpenGL 3.3 core. The functions are those that libGL exports: no loader is needed.
#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <string>

#include "raylab/core/vec.hpp"
#include "raylab/image/image.hpp"

namespace raylab {

/// A compiled and linked pair of shaders.
class GlProgram {
 public:
  /// `name` is for messages. Throws Error (failure) with the compiler's log.
  GlProgram(const char* name, const std::string& vertex, const std::string& fragment);
  ~GlProgram();
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  void use() const { glUseProgram(id_); }
  // Of the program in use. A uniform the shader does not read is no error.
  void set(const char* name, int value) const;
  void set(const char* name, float value) const;
  void set(const char* name, const vec2& value) const;
  void set(const char* name, const vec3& value) const;
  void set(const char* name, const glm::mat4& value) const;

 private:
  GLuint id_;
};

/// One OpenGL object of a kind that is made and deleted by these functions.
template <auto kMake, auto kDelete>
class GlObject {
 public:
  GlObject() { kMake(1, &id_); }
  ~GlObject() {
    if (id_ != 0) kDelete(1, &id_);
  }
  GlObject(GlObject&& other) noexcept : id_(other.id_) { other.id_ = 0; }
  GlObject& operator=(GlObject&&) = delete;
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};
using GlTexture = GlObject<glGenTextures, glDeleteTextures>;
using GlBuffer = GlObject<glGenBuffers, glDeleteBuffers>;
using GlVertexArray = GlObject<glGenVertexArrays, glDeleteVertexArrays>;
using GlFramebuffer = GlObject<glGenFramebuffers, glDeleteFramebuffers>;
using GlRenderbuffer = GlObject<glGenRenderbuffers, glDeleteRenderbuffers>;

/// What the framebuffer bound for reading shows, linear.
Image read_framebuffer(int width, int height);

}  // namespace raylab
