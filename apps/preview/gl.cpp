#include "gl.hpp"

#include <glm/gtc/type_ptr.hpp>
#include <vector>

#include "raylab/core/error.hpp"

namespace raylab {

namespace {

GLuint compiled(const char* name, GLenum kind, const std::string& source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint done = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done == GL_TRUE) return shader;
  char log[2048] = "";
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  glDeleteShader(shader);
  throw Error(ErrorKind::failure, std::string("shader ") + name, log);
}

}  // namespace

GlProgram::GlProgram(const char* name, const std::string& vertex, const std::string& fragment)
    : id_(glCreateProgram()) {
  for (const auto& [kind, source] : {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
    const GLuint shader = compiled(name, kind, source);
    glAttachShader(id_, shader);
    glDeleteShader(shader);  // lives on in the program
  }
  glLinkProgram(id_);
  GLint done = GL_FALSE;
  glGetProgramiv(id_, GL_LINK_STATUS, &done);
  if (done == GL_TRUE) return;
  char log[2048] = "";
  glGetProgramInfoLog(id_, sizeof log, nullptr, log);
  throw Error(ErrorKind::failure, std::string("shader ") + name, log);
}

GlProgram::~GlProgram() { glDeleteProgram(id_); }

void GlProgram::set(const char* name, int value) const { glUniform1i(glGetUniformLocation(id_, name), value); }
void GlProgram::set(const char* name, float value) const { glUniform1f(glGetUniformLocation(id_, name), value); }
void GlProgram::set(const char* name, const vec2& value) const {
  glUniform2f(glGetUniformLocation(id_, name), value.x, value.y);
}
void GlProgram::set(const char* name, const vec3& value) const {
  glUniform3f(glGetUniformLocation(id_, name), value.x, value.y, value.z);
}
void GlProgram::set(const char* name, const glm::mat4& value) const {
  glUniformMatrix4fv(glGetUniformLocation(id_, name), 1, GL_FALSE, glm::value_ptr(value));
}

Image read_framebuffer(int width, int height) {
  std::vector<unsigned char> bytes(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, bytes.data());
  Image image(width, height);
  for (int y = 0; y < height; ++y) {
    // OpenGL counts rows from below.
    const unsigned char* row = &bytes[static_cast<std::size_t>(height - 1 - y) * static_cast<std::size_t>(width) * 3];
    for (int x = 0; x < width; ++x, row += 3) {
      image.at(x, y) = Rgb(srgb_byte_to_linear(row[0]), srgb_byte_to_linear(row[1]), srgb_byte_to_linear(row[2]));
    }
  }
  return image;
}

}  // namespace raylab
