# Materials are folders: NAME/NAME.cpp (the host's part), NAME/NAME.material.h (what kernels do with it; docs/material-guide.md) and
# NAME/NAME.cmake, which says here what the dispatch has to know of it:
#
# lampyris_material(NAME RANK number [EFFECT name [COST text]] [RARELY] [SCATTERS_AS prefix] [ESTIMATES] [SCATTERS_NOTHING])
#
#   RANK              kernels ask for the lowest rank first: what most surfaces are made of comes early
#   EFFECT            kernels of scenes that do not call for this effect (EFFECT_NAME) have no code for the material
#   COST              declares the effect, and says in a few words what it costs
#   RARELY            few scenes have it: the branch to its functions is compiled as unlikely
#   SCATTERS_AS       it is evaluated and sampled by PREFIX_eval and PREFIX_sample, which materials of one rank after the other share
#   ESTIMATES         these two give estimates, and are told which are wanted (`jobs`)
#   SCATTERS_NOTHING  it has a number, but no functions in kernels
cmake_policy(VERSION 3.25)  # as a script, too (below)
set(LAMPYRIS_MATERIALS_DIR ${CMAKE_CURRENT_LIST_DIR}/../src/materials)
set(LAMPYRIS_FIRST_MATERIAL_EFFECT 32)  # bits below are numbered by core/kernel/effects.h

function(lampyris_material name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "RARELY;ESTIMATES;SCATTERS_NOTHING" "RANK;EFFECT;COST;SCATTERS_AS" "")
  set(where "${CMAKE_CURRENT_LIST_FILE}: lampyris_material(${name} ...)")
  if(NOT name STREQUAL material_name)
    message(FATAL_ERROR "${where}: the name is that of the folder, ${material_name}")
  endif()
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_RANK MATCHES "^[0-9]+$" OR (arg_COST AND NOT arg_EFFECT)
     OR (DEFINED arg_EFFECT AND NOT arg_EFFECT MATCHES "^[a-z][a-z0-9]*(-[a-z0-9]+)*$"))
    message(FATAL_ERROR "${where}: wrong arguments: ${ARGN}; cmake/LampyrisMaterials.cmake says what it takes")
  endif()
  if(NOT arg_SCATTERS_AS)
    set(arg_SCATTERS_AS ${name})
  endif()
  set(guard "")
  if(arg_EFFECT)
    string(TOUPPER ${arg_EFFECT} effect)
    string(REPLACE "-" "_" effect EFFECT_${effect})
    set(guard "HAS(${effect}) && ")
    if(arg_COST)
      set_property(GLOBAL PROPERTY LAMPYRIS_EFFECT_OF_${name} "\"${arg_EFFECT}\", \"${arg_COST}\"")
    endif()
    set_property(GLOBAL PROPERTY LAMPYRIS_EFFECT_CONSTANT_${name} ${effect})
  endif()
  set_property(GLOBAL APPEND PROPERTY LAMPYRIS_MATERIALS "${arg_RANK} ${name}")
  foreach(word RARELY ESTIMATES SCATTERS_NOTHING SCATTERS_AS)
    set_property(GLOBAL PROPERTY LAMPYRIS_${word}_${name} ${arg_${word}})
  endforeach()
  set_property(GLOBAL PROPERTY LAMPYRIS_GUARD_${name} "${guard}")
endfunction()

# Adds a folder; `include` is how kernels name its parent ("materials/", or nothing).
function(lampyris_add_material folder include)
  cmake_path(GET folder FILENAME material_name)
  if(NOT material_name MATCHES "^[a-z][a-z0-9]*(_[a-z0-9]+)*$")
    message(FATAL_ERROR "${folder}: a material's folder is named as the material, in lower-case letters, digits and single underscores")
  endif()
  get_property(known GLOBAL PROPERTY LAMPYRIS_MATERIALS)
  if(known MATCHES "(^|;)[0-9]+ ${material_name}(;|$)")
    message(FATAL_ERROR "${folder}: there is a material \"${material_name}\" already")
  endif()
  if(NOT EXISTS ${folder}/${material_name}.cmake)
    message(FATAL_ERROR "${folder}: no ${material_name}.cmake, which says what kind of material it is (docs/material-guide.md)")
  endif()
  include(${folder}/${material_name}.cmake)
  get_property(scatters_nothing GLOBAL PROPERTY LAMPYRIS_SCATTERS_NOTHING_${material_name})
  if("${scatters_nothing}" STREQUAL "")
    message(FATAL_ERROR "${folder}/${material_name}.cmake: does not call lampyris_material(${material_name} ...)")
  endif()
  if(NOT scatters_nothing AND NOT EXISTS ${folder}/${material_name}.material.h)
    message(FATAL_ERROR "${folder}: no ${material_name}.material.h, which has its functions for kernels (docs/material-guide.md)")
  endif()
  set_property(GLOBAL PROPERTY LAMPYRIS_HEADER_${material_name} ${include}${material_name}/${material_name}.material.h)
endfunction()

# The materials of the tree, and those of the folders ARGN; writes list.h and dispatch.h into ${out}/materials.
function(lampyris_generate_materials out)
  set(depends CONFIGURE_DEPENDS)
  if(CMAKE_SCRIPT_MODE_FILE)
    set(depends "")
  endif()
  file(GLOB folders ${depends} LIST_DIRECTORIES true ${LAMPYRIS_MATERIALS_DIR}/*)
  foreach(folder IN LISTS folders)
    if(IS_DIRECTORY ${folder} AND NOT folder MATCHES "/shared$")
      lampyris_add_material(${folder} materials/)
    endif()
  endforeach()
  foreach(folder ${ARGN})
    lampyris_add_material(${folder} "")
  endforeach()
  get_property(materials GLOBAL PROPERTY LAMPYRIS_MATERIALS)
  list(SORT materials COMPARE NATURAL)
  list(TRANSFORM materials REPLACE "^[0-9]+ " "")

  set(numbers "")
  set(effects "")
  set(number 0)
  set(bit ${LAMPYRIS_FIRST_MATERIAL_EFFECT})
  foreach(name IN LISTS materials)
    string(TOUPPER ${name} upper)
    string(APPEND numbers "CONST uint MATERIAL_${upper} = ${number}u;\n")
    math(EXPR number "${number} + 1")
    get_property(effect GLOBAL PROPERTY LAMPYRIS_EFFECT_OF_${name})
    if(effect)
      get_property(constant GLOBAL PROPERTY LAMPYRIS_EFFECT_CONSTANT_${name})
      string(APPEND effects " \\\n    E(${constant}, ${bit}, ${effect})")
      math(EXPR bit "${bit} + 1")
    endif()
  endforeach()
  if(bit GREATER 64)
    message(FATAL_ERROR "the materials declare more effects than a set of effects has bits for")
  endif()

  foreach(part includes make is_specular chooses_lobe transmits albedo visible_action eval sample)
    set(${part} "")
  endforeach()
  set(else "    ")
  set(models "")
  foreach(name IN LISTS materials)
    get_property(scatters_nothing GLOBAL PROPERTY LAMPYRIS_SCATTERS_NOTHING_${name})
    if(scatters_nothing)
      continue()
    endif()
    get_property(header GLOBAL PROPERTY LAMPYRIS_HEADER_${name})
    string(APPEND includes "#include \"${header}\"\n")
    string(TOUPPER ${name} upper)
    get_property(guard GLOBAL PROPERTY LAMPYRIS_GUARD_${name})
    string(APPEND make "${else}if (${guard}kind == MATERIAL_${upper}) {\n        b = ${name}_make(m);\n")
    set(else "    } else ")
    foreach(function is_specular chooses_lobe transmits albedo)
      string(APPEND ${function} "    if (${guard}b.kind == MATERIAL_${upper}) return ${name}_${function}(b);\n")
    endforeach()
    string(APPEND visible_action
      "    if (${guard}b.kind == MATERIAL_${upper}) return ${name}_visible_action(b, roughness);\n")
    # Those that share functions are one branch.
    get_property(model GLOBAL PROPERTY LAMPYRIS_SCATTERS_AS_${name})
    if(model IN_LIST models)
      string(APPEND is_${model} " || b.kind == MATERIAL_${upper}")
      get_property(other GLOBAL PROPERTY LAMPYRIS_GUARD_${first_${model}})
      if(NOT other STREQUAL guard)
        message(FATAL_ERROR "materials ${first_${model}} and ${name} scatter as ${model}, so they have one EFFECT")
      endif()
    else()
      list(APPEND models ${model})
      set(is_${model} "b.kind == MATERIAL_${upper}")
      set(first_${model} ${name})
    endif()
  endforeach()
  string(APPEND make "    } else {\n")

  set(else "    ")
  foreach(model IN LISTS models)
    set(condition "${is_${model}}")
    get_property(guard GLOBAL PROPERTY LAMPYRIS_GUARD_${first_${model}})
    get_property(rarely GLOBAL PROPERTY LAMPYRIS_RARELY_${first_${model}})
    get_property(estimates GLOBAL PROPERTY LAMPYRIS_ESTIMATES_${first_${model}})
    if(rarely)
      set(condition "RARELY(${condition})")
    elseif(guard AND condition MATCHES "\\|\\|")
      set(condition "(${condition})")
    endif()
    set(jobs "")
    set(density "")
    if(estimates)
      set(jobs ", jobs")
      set(density ", density")
    endif()
    string(APPEND eval
      "    if (${guard}${condition}) return ${model}_eval(b, wo, wi, transport${jobs}, pdf);\n")
    string(APPEND sample "${else}if (${guard}${condition}) {\n"
      "        found = ${model}_sample(b, wo, uc, u, transport${jobs}, s${density});\n")
    set(else "    } else ")
  endforeach()
  string(APPEND sample "    }\n")

  file(CONFIGURE OUTPUT ${out}/materials/list.h @ONLY CONTENT [[
// Generated by cmake/LampyrisMaterials.cmake from the folders of materials: do not edit.
#ifndef LAMPYRIS_MATERIALS_LIST
#define LAMPYRIS_MATERIALS_LIST

// MaterialRecord::data.x and Bsdf::kind, in the order in which kernels ask.
@numbers@
// E(constant, bit, name, what it costs): see core/kernel/effects.h.
#define LAMPYRIS_MATERIAL_EFFECTS(E)@effects@

#endif
]])
  configure_file(${LAMPYRIS_MATERIALS_DIR}/dispatch.h.in ${out}/materials/dispatch.h @ONLY)
endfunction()

# As a script, for headers of other folders than a build's own:
#   cmake -DOUTPUT=dir -DFOLDERS=a;b -P LampyrisMaterials.cmake
if(CMAKE_SCRIPT_MODE_FILE AND OUTPUT)
  lampyris_generate_materials(${OUTPUT} ${FOLDERS})
endif()
