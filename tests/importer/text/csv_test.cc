#include "importer/text/csv.h"

#include <sstream>

#include <gmock/gmock.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<CsvRecord> Read(const std::string& text) {
  std::istringstream in(text);
  return ReadCsv(in, "a.csv");
}

std::string ErrorOf(const std::string& text) {
  try {
    Read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Csv, AnyTextComesBackAsItWas) {
  for (const std::string text : {"", "plain", "a,b", "say \"hi\"", "\"", "two\nlines", "cr\r\nlf",
                                 "ends with cr\r", " spaces ", "#5", ",,", "\n#no comment\n"}) {
    const auto records = Read("1," + CsvField(text) + ",\n");
    ASSERT_EQ(records.size(), 1u) << text;
    EXPECT_THAT(records[0].fields, ElementsAre("1", text, ""));
  }
}

TEST(Csv, WrittenRecordsComeBackAsTheyWere) {
  const std::vector<std::vector<std::string>> records = {
      {"c,am \"00\".jpg", "two\nlines"}, {""}, {"", ""}, {"#5"}, {"", "x", ""}};
  std::ostringstream out;
  CsvWriter csv(out);
  for (const std::vector<std::string>& record : records) {
    csv.AddFields(record);
    csv.EndRecord();
  }
  std::vector<std::vector<std::string>> read;
  for (const CsvRecord& record : Read(out.str())) read.push_back(record.fields);
  EXPECT_EQ(read, records);
}

TEST(Csv, NumbersTakeTheirShortestForm) {
  std::ostringstream out;
  CsvWriter csv(out);
  csv.WriteRecord("n", -3, 0.1, 1e-300, true, std::optional<double>(2.0), std::optional<int>());
  EXPECT_EQ(out.str(), "n,-3,0.1,1e-300,1,2,\n");
}

TEST(Csv, PlainTextIsNotQuoted) { EXPECT_EQ(CsvField("hull 2"), "hull 2"); }

TEST(Csv, LinesAreThoseOfTheFile) {
  const auto records = Read("\xEF\xBB\xBFh\r\n# comment\r\n\r\n\"a\nb\",c\r\nlast");
  ASSERT_EQ(records.size(), 3u);
  EXPECT_THAT(records[0].fields, ElementsAre("h"));
  EXPECT_EQ(records[0].line, 1);
  EXPECT_THAT(records[1].fields, ElementsAre("a\nb", "c"));
  EXPECT_EQ(records[1].line, 4);
  EXPECT_THAT(records[2].fields, ElementsAre("last"));
  EXPECT_EQ(records[2].line, 6);
}

TEST(Csv, BadQuotesNameFileAndLine) {
  EXPECT_THAT(ErrorOf("a\n\"b,c\nd\n"), HasSubstr("a.csv:2: a quote is opened and never closed"));
  EXPECT_THAT(ErrorOf("a\n\nb,\"c\"d\n"), HasSubstr("a.csv:3: text follows a closing quote"));
}

}  // namespace
}  // namespace velamap
