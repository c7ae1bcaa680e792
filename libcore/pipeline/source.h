// Where a text of the user says something, and the collection of everything that is wrong with it.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace quoin {

// A file, or one command-line argument (which has no line numbers).
struct SourceText {
    std::string name; // path of the file, or the flag ("-S")
    std::vector<std::string> lines;
    bool is_argument = false;
};

// A place in a text. Line and column count from 1; a default Position is "nowhere".
struct Position {
    std::shared_ptr<const SourceText> source;
    int line = 0;
    int column = 0;
};

std::shared_ptr<const SourceText> make_source(std::string name, const std::string& text);
Position argument_position(const std::string& flag, const std::string& argument, int column = 1);

std::string to_string(const Position& position); // "file:line:column", or the flag of an argument

// Everything wrong with a pipeline, so that the user sees it at once and before anything runs.
class Problems {
public:
    void add(const Position& position, const std::string& message);
    void add_all(const Problems& others);
    void warn(const Position& position, const std::string& message); // stops nobody
    bool empty() const { return entries_.empty(); }
    bool has_errors() const { return errors_ > 0; }

    // Every problem in the order of the texts: position and message, the source line, a caret.
    std::string text() const;

    // Throws UsageError with text() if there are errors.
    void throw_if_any() const;

private:
    void put(const Position& position, std::string message);
    struct Entry {
        Position position;
        std::string message;
    };
    std::vector<Entry> entries_;
    std::size_t errors_ = 0;
};

// "; did you mean 'fuse'?" when a candidate is near, else "; there is: fuse, merge", else "".
std::string hint(const std::string& name, const std::vector<std::string>& candidates);

} // namespace quoin
