/* The parts of POSIX that `tests/host.c` uses, on Windows. */

#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

#define RTLD_NOW 0
#define RTLD_LOCAL 0

static inline void *dlopen(const char *path, int flags)
{
    wchar_t wide[4096];
    (void)flags;
    if (!MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, 4096)) return NULL;
    return (void *)LoadLibraryExW(wide, NULL, LOAD_WITH_ALTERED_SEARCH_PATH);
}

static inline void *dlsym(void *library, const char *name)
{
    return (void *)(size_t)GetProcAddress((HMODULE)library, name);
}

static inline int dlclose(void *library) { return !FreeLibrary((HMODULE)library); }

static inline const char *dlerror(void)
{
    static char text[32];
    snprintf(text, sizeof text, "Windows error %lu", GetLastError());
    return text;
}

static inline ssize_t getline(char **line, size_t *capacity, FILE *stream)
{
    size_t length = 0;
    for (int c; (c = getc(stream)) != EOF;) {
        if (length + 2 > *capacity) {
            *capacity = 2 * *capacity + 128;
            *line = realloc(*line, *capacity);
            if (!*line) return -1;
        }
        (*line)[length++] = (char)c;
        if (c == '\n') break;
    }
    if (length) (*line)[length] = '\0';
    return length ? (ssize_t)length : -1;
}
