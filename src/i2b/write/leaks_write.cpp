#include "i2b/write/leaks_write.h"
#include "i2b/write/output_file.h"
#include <cstring>
#include <fmt/format.h>

namespace i2b {
namespace {

template <class T>
void append(std::string& out, const T& value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.append(bytes, sizeof value);
}

} // namespace

void writeLeaks(const std::vector<Leak>& leaks, const std::filesystem::path& path) {
    std::size_t faces = 0;
    for (const Leak& leak : leaks) faces += leak.faces.size();
    OutputFile file(path);
    file.write(fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
                           "element face {}\nproperty list uchar int vertex_indices\nproperty int leak\nend_header\n",
                           4 * faces, faces));
    std::string out;
    for (const Leak& leak : leaks) {
        for (const auto& face : leak.faces)
            for (const Vec3& p : face) append(out, p.x), append(out, p.y), append(out, p.z);
        file.write(out);
        out.clear();
    }
    std::int32_t vertex = 0;
    for (std::size_t i = 0; i < leaks.size(); ++i) {
        for (std::size_t k = 0; k < leaks[i].faces.size(); ++k) {
            append(out, std::uint8_t(4));
            for (int corner = 0; corner < 4; ++corner) append(out, vertex++);
            append(out, static_cast<std::int32_t>(i));
        }
        file.write(out);
        out.clear();
    }
    file.close();
}

} // namespace i2b
