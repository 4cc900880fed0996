autocmd BufRead,BufNewFile *.lss setfiletype lss
