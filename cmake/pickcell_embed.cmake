# pickcell_embed(TARGET NAME FILE): the bytes of FILE as `extern const char NAME[]` and `extern const std::size_t NAME_size`
# in TARGET, made anew whenever FILE changes. Also the script that does it (cmake -P).
if(CMAKE_SCRIPT_MODE_FILE)
  file(READ ${INPUT} hex HEX)
  string(LENGTH "${hex}" digits)
  math(EXPR size "${digits} / 2")
  string(REPEAT "[0-9a-f]" 32 sixteen_bytes)
  string(REGEX REPLACE "(${sixteen_bytes})" "\\1\n" bytes "${hex}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  file(WRITE ${OUTPUT} "#include <cstddef>\nextern const char ${NAME}[];\nextern const std::size_t ${NAME}_size;\n"
    "const char ${NAME}[] = {${bytes}0};\nconst std::size_t ${NAME}_size = ${size};\n")
  return()
endif()

set(PICKCELL_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

function(pickcell_embed TARGET NAME FILE)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded/${NAME}.cpp)
  add_custom_command(OUTPUT ${output} DEPENDS ${FILE} ${PICKCELL_EMBED_SCRIPT}
    COMMAND ${CMAKE_COMMAND} -DINPUT=${FILE} -DOUTPUT=${output} -DNAME=${NAME} -P ${PICKCELL_EMBED_SCRIPT}
    COMMENT "Embedding ${NAME}" VERBATIM)
  target_sources(${TARGET} PRIVATE ${output})
endfunction()
