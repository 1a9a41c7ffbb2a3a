#include "i2b/core/error.h"

namespace i2b {
namespace {

std::string sentence(const std::string& what, const std::string& where, const std::string& remedy) {
    std::string text = what;
    if (!where.empty()) text += " (" + where + ")";
    if (!remedy.empty()) text += ": " + remedy;
    return text;
}

} // namespace

Error::Error(ErrorKind kind, std::string what, std::string where, std::string remedy)
    : std::runtime_error(sentence(what, where, remedy)), kind_(kind), problem_(std::move(what)),
      where_(std::move(where)), remedy_(std::move(remedy)) {}

int Error::exitStatus() const {
    switch (kind_) {
    case ErrorKind::input: return 1;
    case ErrorKind::usage: return 2;
    case ErrorKind::internal: return 3;
    }
    return 3;
}

} // namespace i2b
