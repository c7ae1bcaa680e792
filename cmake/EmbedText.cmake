# cmake -D "NAMES=a.js;b.css" -D FOLDER=dir -D OUT=file.cpp -P EmbedText.cmake: text files as the function page_text(name).
set(text "// Made from ${FOLDER} by the build.\n#include \"report/page_text.h\"\n\nnamespace quoin {\n\nstd::string_view page_text(std::string_view name)\n{\n")
foreach(name ${NAMES})
    file(READ ${FOLDER}/${name} content)
    string(APPEND text "    if (name == \"${name}\")\n        return R\"quoin(${content})quoin\";\n")
endforeach()
string(APPEND text "    return {};\n}\n\n} // namespace quoin\n")
file(WRITE ${OUT} "${text}")
