/* Calls the host's `main`, here `host_main`, with arguments in UTF-8: the ones of an ordinary
 * `main` have only the characters of the system's code page. */

#include <windows.h>

int host_main(int argc, char **argv);

int wmain(int argc, wchar_t **wide)
{
    enum { MOST = 16 };
    static char text[MOST][4096];
    char *argv[MOST + 1] = {NULL};
    if (argc > MOST) return 1;
    for (int k = 0; k < argc; k++) {
        WideCharToMultiByte(CP_UTF8, 0, wide[k], -1, text[k], sizeof text[k], NULL, NULL);
        argv[k] = text[k];
    }
    return host_main(argc, argv);
}
