// The one exception type of the library, thrown only at its edge (reading input, checking options, refusing a
// case, writing files). Inside a stage errors are values; assertions are for our own faults.
#pragma once
#include <stdexcept>
#include <string>

namespace i2b {

enum class ErrorKind {
    input,   // the input cannot be meshed as asked; exit status 1
    usage,   // the command line or case file is wrong; exit status 2
    internal // a fault of ours; exit status 3
};

// Three short texts: what is wrong, where (file, line, key, coordinates), and what the user can do about it.
class Error : public std::runtime_error {
  public:
    Error(ErrorKind kind, std::string what, std::string where, std::string remedy);

    ErrorKind kind() const { return kind_; }
    int exitStatus() const;
    const std::string& problem() const { return problem_; }
    const std::string& where() const { return where_; }
    const std::string& remedy() const { return remedy_; }

  private:
    ErrorKind kind_;
    std::string problem_, where_, remedy_;
};

// Thrown by Context::checkCancelled() when the user has asked to stop; the program ends with status 130.
class Cancelled : public std::runtime_error {
  public:
    Cancelled() : std::runtime_error("cancelled") {}
};

} // namespace i2b
