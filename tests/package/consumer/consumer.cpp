// Fails unless the installed headers and library answer: a checksum that depends on its input.
#include "i2b/core/checksum.h"

int main() {
    i2b::Checksum a, b;
    a.add(1.0);
    b.add(2.0);
    return a.hex().size() == 16 && a.hex() != b.hex() ? 0 : 1;
}
