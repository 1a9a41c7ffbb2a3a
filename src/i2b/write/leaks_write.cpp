#include "i2b/write/leaks_write.h"
#include "i2b/write/output_file.h"
#include <array>
#include <fmt/format.h>

namespace i2b {

static_assert(sizeof(Vec3) == 3 * sizeof(double)); // as the header says

void writeLeaks(const std::vector<Leak>& leaks, const std::filesystem::path& path) {
    std::size_t faces = 0;
    for (const Leak& leak : leaks) faces += leak.faces.size();
    OutputFile file(path);
    file.write(fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
                           "element face {}\nproperty list uchar int vertex_indices\nproperty int leak\nend_header\n",
                           4 * faces, faces));
    for (const Leak& leak : leaks)
        for (const auto& face : leak.faces) file.write(face.data(), sizeof face);
    std::int32_t vertex = 0;
    for (std::size_t i = 0; i < leaks.size(); ++i) {
        const auto number = static_cast<std::int32_t>(i);
        for (std::size_t k = 0; k < leaks[i].faces.size(); ++k, vertex += 4) {
            const std::uint8_t count = 4;
            const std::array<std::int32_t, 5> face{vertex, vertex + 1, vertex + 2, vertex + 3, number};
            file.write(&count, sizeof count), file.write(face.data(), sizeof face);
        }
    }
    file.close();
}

} // namespace i2b
