" Conveyor track layouts (.lss). Keywords count by their place in a line, since names may be spelt like them.
if exists("b:current_syntax")
  finish
endif

syntax case match

syntax match lssOperator "\.\.\|<=\|>=\|==\|[-+*=<>≤≥]\|/\ze[^/]"
syntax match lssFunction "\<\h\w*\ze("
syntax match lssUnit contained "[A-Za-z%°µΩ€][[:alnum:]_%°µΩ€^.*/-]*"
syntax match lssNumber "\<\d[0-9_]*\%(\.\d[0-9_]*\)\=\%([eE][+-]\=\d\+\)\=\%(\s*\%(\%(radius\|clearance\|evenly\|from\|slope\|every\|count\|step\|within\|at\|on\|about\|anywhere\|fed\|for\|changeover\|spread\)\>\)\@!\a\|\s*[%°µΩ€]\)\@=" nextgroup=lssUnit skipwhite
syntax match lssNumber "\<\d[0-9_]*\%(\.\d[0-9_]*\)\=\%([eE][+-]\=\d\+\)\=\%(\s*\%([-+*/=<>,)\].]\|$\|\%(radius\|clearance\|evenly\|from\|slope\|every\|count\|step\|within\|at\|on\|about\|anywhere\|fed\|for\|changeover\|spread\)\>\)\)\@="
syntax match lssWord "\<\%(from\|on\|at\|every\|count\|evenly\|radius\|clearance\|slope\|within\|about\|step\|tension\|closes\|of\|least\|anywhere\|straights\|after\|before\|the\|last\|each\|zone\|fed\|for\|to\|changeover\|spread\)\>\%(\s\+[^=:,) \t]\|\s*$\)\@="
syntax match lssConstant "\<\%(left\|right\|either\)\>\%(\s*\%(//.*\)\=$\)\@="
syntax match lssStatement "\%(^\|{\)\@<=\s*\%(use\|speed\|width\|vertex\|building\|obstacle\|turns\|radii\|fix\|require\|equal\|mirror\|pass\|level\|ramp\|start\|photocell\|scanner\|feed\|storage\|items\|stops\|fails\|waves\|wave\|choose\|drive\|energy\|induction\|chutes\|gate\|lift\|motors\|supports\|sensor_cart\|chain\|effect\|axis\|drawing\|optimi[sz]e\|section\|route\)\>\%(\s\+[^=:,) \t]\)\@="
syntax match lssDeclaration "^\s*\%(layout\|catalog\|cart\|wheel\|joint\|motor\|controller\|sensor\|equipment\|let\)\>\%(\s\+\h\)\@="
syntax match lssEscape contained "\\[\"\\]"
syntax region lssText start=+"+ skip=+\\.+ end=+"\|$+ contains=lssEscape
syntax match lssComment "//.*$" contains=@Spell

highlight default link lssOperator Operator
highlight default link lssFunction Function
highlight default link lssNumber Number
highlight default link lssUnit Type
highlight default link lssWord Keyword
highlight default link lssConstant Constant
highlight default link lssStatement Statement
highlight default link lssDeclaration Structure
highlight default link lssEscape SpecialChar
highlight default link lssText String
highlight default link lssComment Comment

let b:current_syntax = "lss"
